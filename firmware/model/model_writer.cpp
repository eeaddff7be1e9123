#include <optional>
#include <sstream>
#include <vector>

#include "firmware/model/model_fields.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/validation.hpp"
#include "firmware/toml/toml.hpp"

namespace zerorate::model {
namespace {

/// `text` in double quotes, escaped.
std::string toml_string(std::string_view text) {
  std::ostringstream out;
  const toml::value<std::string> value(text);
  out << toml::toml_formatter(value, toml::format_flags::allow_unicode_strings);
  return out.str();
}

/// A visitor of model_fields.hpp that writes `key = value` lines.
class Writer {
 public:
  void number(std::string_view key, double si, FileUnit unit, const Rule& /*rule*/,
              Presence /*presence*/) {
    line(key, decimal_from_si(si, unit));
  }
  void text(std::string_view key, const std::string& value, Presence presence) {
    if (presence == Presence::required || !value.empty()) {
      line(key, toml_string(value));
    }
  }
  void start(std::string_view key, core::Start value) { line(key, toml_string(start_name(value))); }

  template <class Part>
  void table(std::string_view key, const Part& part, Presence /*presence*/) {
    text_ += "\n[" + std::string(key) + "]\n";
    visit_fields(*this, part);
  }
  template <class Part>
  void table(std::string_view key, const std::optional<Part>& part) {
    if (part) {
      table(key, *part, Presence::required);
    }
  }
  template <class Part>
  void tables(std::string_view key, const std::vector<Part>& parts) {
    for (const Part& part : parts) {
      text_ += "\n[[" + std::string(key) + "]]\n";
      visit_fields(*this, part);
    }
  }

  void line(std::string_view key, std::string_view value) {
    text_.append(key).append(" = ").append(value).append("\n");
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string format_model(const SensorModel& model) {
  validate(model);
  Writer writer;
  writer.line("schema", toml_string(kModelSchema));
  visit_fields(writer, model);
  return writer.text();
}

}  // namespace zerorate::model
