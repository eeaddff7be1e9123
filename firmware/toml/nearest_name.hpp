/// @file
/// "Did you mean ...?"
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace zerorate::toml_file {

/// `; did you mean "NAME"?` with the candidate that is fewest edits away from `name`, or nothing
/// where none is near (more than a third of the letters would have to change).
[[nodiscard]] std::string suggestion(std::string_view name,
                                     std::span<const std::string_view> candidates);

}  // namespace zerorate::toml_file
