#include <nlohmann/json.hpp>
#include <ostream>

#include "profile/report_page.hpp"
#include "profile/sweep_output.hpp"

namespace raymill::profile {

void write_report(std::ostream& out, const nlohmann::ordered_json& sweep) {
    const ReportPage& page = report_page();
    const std::string data = sweep.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    out << page.before_data;
    // A script element ends at "</script" wherever it stands; in JSON a '<' is always part of a string.
    for (const char c : data) c == '<' ? out << "\\u003c" : out << c;
    out << page.after_data;
}

}  // namespace raymill::profile
