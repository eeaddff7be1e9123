#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::consistent:
      return "consistent";
    case Verdict::explained:
      return "explained";
    case Verdict::unexplained:
      return "unexplained";
  }
  return "unexplained";
}

}  // namespace zerorate::diagnose
