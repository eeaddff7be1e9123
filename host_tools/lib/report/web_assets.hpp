/// @file
/// Style and scripts that every report contains: generated from web/ and from the npm package uplot
/// at build time (embed_text.cmake). Internal to the report.
#pragma once

#include <string_view>

namespace zerorate::report {

extern const std::string_view kReportStyle;
extern const std::string_view kReportScript;
extern const std::string_view kPlotStyle;
extern const std::string_view kPlotScript;
extern const std::string_view kPlotLicence;

}  // namespace zerorate::report
