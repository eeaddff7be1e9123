/// @file
/// Style and scripts that every report contains: generated from web/ and from the npm package uplot
/// at build time (embed_text.cmake). For the report and the page of a running node.
#pragma once

#include <string_view>

namespace zerorate::report {

extern const std::string_view kReportStyle;
extern const std::string_view kReportScript;
extern const std::string_view kLivePage;
extern const std::string_view kLiveScript;
extern const std::string_view kLiveStyle;
extern const std::string_view kPlotStyle;
extern const std::string_view kPlotScript;
extern const std::string_view kPlotLicence;

}  // namespace zerorate::report
