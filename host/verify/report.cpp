#include "verify/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace raymill::verify {

double Field::ratio() const {
    if (kernel == reference) return 0;
    const double error = std::abs(kernel - reference);
    if (!(error < INFINITY)) return std::isinf(bound) ? 0 : INFINITY;
    return bound > 0 ? error / bound : INFINITY;
}

void Comparison::number(std::string name, double kernel, double reference, double bound) {
    fields.push_back({std::move(name), kernel, reference, bound});
}

void Comparison::vector(const std::string& name, const float (&kernel)[3], const dvec3& reference, const dvec3& bound) {
    for (int c = 0; c < 3; ++c) number(fmt::format("{}[{}]", name, c), kernel[c], reference[c], bound[c]);
}

void Comparison::same(std::string name, std::uint64_t kernel, std::uint64_t reference) {
    number(std::move(name), static_cast<double>(kernel), static_cast<double>(reference), 0);
}

double Comparison::ratio() const {
    double worst = 0;
    if (!disagreement)
        for (const Field& field : fields) worst = std::max(worst, field.ratio());
    return worst;
}

bool Comparison::failed() const {
    return disagreement ? !disagreement->excused() : !(ratio() <= 1);
}

namespace {

std::string in_full(const Comparison& comparison) {
    std::string text;
    if (comparison.disagreement)
        text += fmt::format("  {}; margin {:.6g} of the bound\n", comparison.disagreement->what,
                            comparison.disagreement->margin);
    if (!comparison.fields.empty())
        text += fmt::format("  {:<24}{:>16}{:>16}{:>14}{:>14}\n", "field", "kernel", "reference", "error", "bound");
    for (const Field& field : comparison.fields)
        text +=
            fmt::format("  {:<24}{:>16.9g}{:>16.9g}{:>14.6g}{:>14.6g}{}\n", field.name, field.kernel, field.reference,
                        std::abs(field.kernel - field.reference), field.bound, field.ratio() <= 1 ? "" : "  <--");
    return text;
}

}  // namespace

void StageReport::add(const Comparison& comparison, const std::function<std::string()>& describe) {
    ++compared_;
    if (comparison.disagreement) {
        ++disagreements_;
        if (comparison.disagreement->excused())
            largest_margin_ = std::max(largest_margin_, comparison.disagreement->margin);
    } else {
        const double ratio = comparison.ratio();
        worst_ = std::max(worst_, ratio);
        ratios_.push_back(static_cast<float>(ratio));
    }
    if (!comparison.failed()) return;
    if (failures_++ == 0) first_failure_ = describe() + in_full(comparison);
}

void StageReport::fail(const std::string& text) {
    if (failures_++ == 0) first_failure_ = "  " + text + "\n";
}

double StageReport::typical() const {
    if (ratios_.empty()) return 0;
    std::vector<float> sorted = ratios_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
}

std::string report_text(const std::vector<StageReport>& reports) {
    std::string text = fmt::format("{:<11}{:>11}{:>11}{:>12}{:>12}{:>11}{:>12}{:>9}\n", "kernel", "items", "compared",
                                   "worst", "typical", "disagree", "margin", "failed");
    for (const StageReport& r : reports)
        text += fmt::format("{:<11}{:>11}{:>11}{:>12.6g}{:>12.6g}{:>11}{:>12.6g}{:>9}\n", r.stage(), r.items(),
                            r.compared(), r.worst(), r.typical(), r.disagreements(), r.largest_margin(), r.failures());
    for (const StageReport& r : reports)
        if (r.failures() > 0)
            text += fmt::format("\n{}: {} out of bounds; the first:\n{}", r.stage(), r.failures(), r.first_failure());
    return text;
}

}  // namespace raymill::verify
