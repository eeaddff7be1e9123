#include "host_tools/lib/recording/exports.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/fields.hpp"

namespace zerorate::recording {
namespace {

/// An export of a program, as the options that read it.
struct Export {
  std::string_view program;
  std::string_view columns;
  std::string_view units;
  std::string_view where = {};   ///< rows of one sensor, where the log has several
  std::string_view marker = {};  ///< a further name in the header
  std::string_view file = {};    ///< part of the name of the file
};

constexpr std::array kExports = {
    Export{.program = "phyphox",
           .columns = "t=Time (s),gx=Gyroscope x (rad/s),gy=Gyroscope y (rad/s),"
                      "gz=Gyroscope z (rad/s)",
           .units = "time=s,rate=radps"},
    Export{.program = "Sensor Logger",
           .columns = "t=time,gx=x,gy=y,gz=z",
           .units = "time=ns,rate=radps",
           .marker = "seconds_elapsed",
           .file = "Gyroscope"},
    Export{.program = "AndroSensor",
           .columns = "t=Time since start in ms,gx=GYROSCOPE X (rad/s),gy=GYROSCOPE Y (rad/s),"
                      "gz=GYROSCOPE Z (rad/s)",
           .units = "time=ms,rate=radps"},
    Export{.program = "AndroSensor",
           .columns = "t=YYYY-MO-DD HH-MI-SS_SSS,gx=GYROSCOPE X (rad/s),gy=GYROSCOPE Y (rad/s),"
                      "gz=GYROSCOPE Z (rad/s)",
           .units = "time=iso,rate=radps"},
    Export{.program = "PX4 (sensor_combined)",
           .columns = "t=timestamp,gx=gyro_rad[0],gy=gyro_rad[1],gz=gyro_rad[2],"
                      "ax=accelerometer_m_s2[0],ay=accelerometer_m_s2[1],az=accelerometer_m_s2[2]",
           .units = "time=us,rate=radps,acceleration=mps2"},
    Export{.program = "PX4 (sensor_gyro)",
           .columns = "t=timestamp,gx=x,gy=y,gz=z,temp=temperature",
           .units = "time=us,rate=radps,temp=c",
           .marker = "device_id",
           .file = "sensor_gyro"},
    Export{.program = "PX4 (vehicle_imu)",
           .columns = "t=timestamp,gx=delta_angle[0],gy=delta_angle[1],gz=delta_angle[2]",
           .units = "time=us,rate=rad/sample",
           .marker = "delta_angle_dt"},
    Export{.program = "ArduPilot (IMU, the first one)",
           .columns = "t=TimeUS,gx=GyrX,gy=GyrY,gz=GyrZ,ax=AccX,ay=AccY,az=AccZ",
           .units = "time=us,rate=radps,acceleration=mps2",
           .where = "I=0",
           .marker = "I"},
    Export{.program = "ArduPilot (IMU)",
           .columns = "t=TimeUS,gx=GyrX,gy=GyrY,gz=GyrZ,ax=AccX,ay=AccY,az=AccZ",
           .units = "time=us,rate=radps,acceleration=mps2"},
    Export{.program = "Blackbox",
           .columns = "t=time (us),gx=gyroADC[0],gy=gyroADC[1],gz=gyroADC[2]",
           .units = "time=us,rate=dps",
           .marker = "loopIteration"},
    Export{.program = "Blackbox",
           .columns = "t=time (us),gx=gyroADC[0] (deg/s),gy=gyroADC[1] (deg/s),"
                      "gz=gyroADC[2] (deg/s)",
           .units = "time=us,rate=dps",
           .marker = "loopIteration"},
    Export{.program = "Blackbox",
           .columns = "t=time,gx=gyroADC[0],gy=gyroADC[1],gz=gyroADC[2]",
           .units = "time=us,rate=dps",
           .marker = "loopIteration"},
};

constexpr std::array kSeparators{',', ';', '\t'};

/// The first `kMostLines` whole lines of a text.
std::vector<std::string_view> lines_of(std::string_view text) {
  constexpr std::size_t kMostLines = 1'000;
  std::vector<std::string_view> lines;
  for (std::size_t end = text.find('\n');
       end != std::string_view::npos && lines.size() < kMostLines; end = text.find('\n')) {
    lines.push_back(text.substr(0, end));
    if (lines.back().ends_with('\r')) lines.back().remove_suffix(1);
    text.remove_prefix(end + 1);
  }
  return lines;
}

bool has_names(std::string_view line, char delimiter, const std::vector<std::string_view>& names) {
  std::vector<std::string_view> fields;
  for (Fields each{line, delimiter}; each.next();) fields.push_back(each.text());
  return std::ranges::all_of(names, [&](std::string_view name) {
    return std::ranges::find(fields, name) != fields.end();
  });
}

/// A header line and what separates its names.
struct Found {
  std::size_t line = 0;
  char delimiter = ',';
};

std::optional<Found> find_header(const std::vector<std::string_view>& lines, char delimiter,
                                 const std::vector<std::string_view>& names) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const char candidate : kSeparators) {
      if (delimiter != '\0' && candidate != delimiter) continue;
      if (has_names(lines[i], candidate, names)) return Found{i, candidate};
    }
  }
  return std::nullopt;
}

std::vector<std::string_view> names_in(const Layout& layout) {
  std::vector<std::string_view> names;
  for (const auto& [key, name] : layout.columns) {
    if (!name.starts_with('#')) names.emplace_back(name);
  }
  return names;
}

/// Whether the numbers of a row have decimal commas: no point, and a comma in a field.
bool has_decimal_commas(std::string_view row, char delimiter) {
  return delimiter != ',' && row.find('.') == std::string_view::npos &&
         row.find(',') != std::string_view::npos;
}

}  // namespace

CompletedLayout complete_layout(const Layout& said, std::string_view ahead,
                                const std::filesystem::path& file) {
  CompletedLayout result{said, {}};
  const std::vector<std::string_view> lines = lines_of(ahead);
  if (!said.columns.empty()) {
    const std::vector<std::string_view> names = names_in(said);
    if (said.skipped_lines > 0 || names.empty()) return result;
    const auto header = find_header(lines, said.delimiter, names);
    if (header) result.layout.skipped_lines = header->line;
    return result;
  }
  const std::string name = file.filename().string();
  for (const Export& one : kExports) {
    if (name.find(one.file) == std::string::npos) continue;
    Layout layout = said;
    layout.set_columns(one.columns);
    std::vector<std::string_view> names = names_in(layout);
    if (!one.marker.empty()) names.push_back(one.marker);
    const auto header = find_header(lines, said.delimiter, names);
    if (!header) continue;
    layout.set_units(one.units);
    for (const auto& unit : said.units) layout.units[unit.first] = unit.second;
    if (said.where.empty()) layout.set_where(one.where);
    layout.delimiter = header->delimiter;
    layout.skipped_lines = header->line;
    layout.decimal_comma =
        said.decimal_comma || (header->line + 1 < lines.size() &&
                               has_decimal_commas(lines[header->line + 1], header->delimiter));
    return {layout, one.program};
  }
  return result;
}

}  // namespace zerorate::recording
