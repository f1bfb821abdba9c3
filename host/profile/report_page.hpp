// The page of report/, put together at build time.
#pragma once

#include <string_view>

namespace raymill::profile {

/// What stands before and after the sweep's JSON.
struct ReportPage {
    std::string_view before_data;
    std::string_view after_data;
};

const ReportPage& report_page();

}  // namespace raymill::profile
