/// @file
/// Why a file that a person wrote cannot be used.
#pragma once

#include <stdexcept>

namespace zerorate::toml_file {

/// what() is `file:line:column: what is wrong`.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace zerorate::toml_file
