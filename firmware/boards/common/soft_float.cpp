// Cases that soft_float.S leaves over: operands or results that are not normal numbers.

#include "firmware/boards/common/soft_float.hpp"

extern "C" {

zerorate::soft_float::Bits zerorate_multiply(zerorate::soft_float::Bits a,
                                             zerorate::soft_float::Bits b) {
  return zerorate::soft_float::multiply(a, b);
}

zerorate::soft_float::Bits zerorate_add(zerorate::soft_float::Bits a,
                                        zerorate::soft_float::Bits b) {
  return zerorate::soft_float::add(a, b);
}
}
