#include "scene/number_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

namespace raymill {

bool parse_number(std::string_view word, double& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault == std::errc::invalid_argument) return false;
    if (fault == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
    const std::string_view rest(end, static_cast<std::size_t>(word.data() + word.size() - end));
    if (rest.starts_with("#INF"))
        value = std::copysign(std::numeric_limits<double>::infinity(), value);
    else if (rest.starts_with("#IND") || rest.starts_with("#QNAN") || rest.starts_with("#SNAN"))
        value = std::numeric_limits<double>::quiet_NaN();
    else
        return rest.empty();
    return true;
}

}  // namespace raymill
