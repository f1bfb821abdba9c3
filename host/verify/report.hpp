// What the comparison of a queue with the reference found.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "verify/bounded.hpp"

namespace raymill::verify {

/// A number of an item, twice. A bound of zero asks for the same number.
struct Field {
    std::string name;
    double kernel = 0, reference = 0, bound = 0;

    /// Error over bound; at most 1 is within it, NaN or a difference from an exact number is infinite.
    double ratio() const;
};

/// The kernel took another branch than the reference. margin: how far the reference is from the border between them,
/// over the bound on what rounding may move it by; below 1 both branches are right.
struct Disagreement {
    std::string what;
    double margin = 0;
    bool excused() const { return margin < 1; }
};

/// How one item fared.
struct Comparison {
    std::vector<Field> fields;
    std::optional<Disagreement> disagreement;

    void number(std::string name, double kernel, double reference, double bound);
    void vector(const std::string& name, const float (&kernel)[3], const dvec3& reference, const dvec3& bound);
    void same(std::string name, std::uint64_t kernel, std::uint64_t reference);
    void disagree(std::string what, double margin) { disagreement = Disagreement{std::move(what), margin}; }

    /// Largest ratio of the fields; fields of an item whose branch differs do not count.
    double ratio() const;
    bool failed() const;
};

/// One kernel's items over a frame.
class StageReport {
  public:
    explicit StageReport(std::string stage) : stage_(std::move(stage)) {}

    /// Adds an item that was compared. describe: the item in full; called for the first that fails.
    void add(const Comparison& comparison, const std::function<std::string()>& describe);
    /// Items that the queue held, compared or not.
    void count(std::uint64_t items) { items_ += items; }
    /// A fault that belongs to no single item.
    void fail(const std::string& text);

    const std::string& stage() const { return stage_; }
    std::uint64_t items() const { return items_; }
    std::uint64_t compared() const { return compared_; }
    double worst() const { return worst_; }
    /// Median of the items' largest ratios.
    double typical() const;
    std::uint64_t disagreements() const { return disagreements_; }
    double largest_margin() const { return largest_margin_; }
    std::uint64_t failures() const { return failures_; }
    /// The first item out of bounds, field by field; empty if there is none.
    const std::string& first_failure() const { return first_failure_; }

  private:
    std::string stage_;
    std::uint64_t items_ = 0, compared_ = 0, disagreements_ = 0, failures_ = 0;
    double worst_ = 0, largest_margin_ = 0;
    std::vector<float> ratios_;
    std::string first_failure_;
};

/// The table of all kernels, then the first item out of bounds of each. Plain text.
std::string report_text(const std::vector<StageReport>& reports);

}  // namespace raymill::verify
