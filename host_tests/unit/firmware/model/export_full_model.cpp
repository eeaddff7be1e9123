// Writes the full model as the headers that exported_model_test.cpp compiles.
#include <fstream>

#include "firmware/model/source_headers.hpp"
#include "host_tests/unit/firmware/model/full_model.hpp"

int main() {
  using namespace zerorate::model;
  std::ofstream("full_model.h") << format_c_header(full_model_for_c(), kFullPeriod, kFullTick,
                                                   "full_model");
  std::ofstream("full_model_params.hpp") << format_cpp_header(full_model(), kFullPeriod, kFullTick);
}
