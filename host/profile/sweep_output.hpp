// A sweep as JSON, CSV, a table and a page. docs/profile.md describes the keys and columns.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "profile/sweep.hpp"

namespace raymill::profile {

/// Launches and waves of the timeline that the JSON keeps; the trace has all of them.
inline constexpr std::size_t kept_launches = 20000;

/// Keys in the order of docs/profile.md.
nlohmann::ordered_json to_json(const Sweep& sweep);

/// One line of column names, then one row for every setting that was measured, depth and stage.
void write_csv(std::ostream& out, const Sweep& sweep);

/// A line a setting, then the finding.
std::string table(const Sweep& sweep);

/// The report: one page that needs nothing beside it. `sweep` is what to_json() made; every number on the page comes
/// from there.
void write_report(std::ostream& out, const nlohmann::ordered_json& sweep);

}  // namespace raymill::profile
