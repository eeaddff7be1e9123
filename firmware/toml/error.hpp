/// @file
/// Why a file that a person wrote cannot be used, and what its author may have meant.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::toml_file {

/// `what()` is `file:line:column: reason`.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Mistakes of one file, so that a person who reads of one reads of all.
class ErrorList {
 public:
  /// Keeps the message of an Error that `act` throws.
  /// @return whether there was none
  template <class Act>
  bool attempt(Act act) {
    try {
      act();
    } catch (const Error& error) {
      if (std::ranges::find(messages_, error.what()) == messages_.end()) {
        messages_.emplace_back(error.what());
      }
      return false;
    }
    return true;
  }
  [[nodiscard]] bool is_empty() const { return messages_.empty(); }
  /// Throws an Error of all messages, one a line, where there are any.
  void raise() const {
    if (is_empty()) return;
    std::string text;
    for (const std::string& message : messages_) text += (text.empty() ? "" : "\n") + message;
    throw Error(text);
  }

 private:
  std::vector<std::string> messages_;
};

/// `; did you mean "NAME"?` with the candidate that is fewest edits away from `name`, or nothing
/// where none is near (more than a third of the letters would have to change).
[[nodiscard]] std::string suggestion(std::string_view name,
                                     std::span<const std::string_view> candidates);

}  // namespace zerorate::toml_file
