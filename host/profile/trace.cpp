#include "profile/trace.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

namespace raymill::profile {

using Json = nlohmann::ordered_json;

namespace {

constexpr int process = 1;
constexpr int host_track = 1;
constexpr int device_track = 2;

/// Writes one event a line: a frame's launches may be millions.
class Events {
  public:
    Events(std::ostream& out, std::int64_t start) : out_(out), start_(start) { out_ << "{\"traceEvents\": [\n"; }

    void name_process(const std::string& name) {
        write({{"name", "process_name"}, {"ph", "M"}, {"pid", process}, {"args", {{"name", name}}}});
    }
    void name_track(int track, const std::string& name) {
        Json event = {{"name", "thread_name"}, {"ph", "M"}, {"pid", process}, {"tid", track}};
        event["args"] = {{"name", name}};
        write(event);
    }
    void complete(int track, std::string_view name, std::int64_t start, std::int64_t end, Json arguments) {
        Json event = {{"name", name}, {"ph", "X"}, {"pid", process}, {"tid", track}};
        event["ts"] = microseconds(start);
        event["dur"] = 1e-3 * static_cast<double>(end - start);
        event["args"] = std::move(arguments);
        write(event);
    }
    void fill(int depth, std::int64_t time, std::int64_t rays) {
        Json event = {{"name", fmt::format("queue of depth {}", depth)}, {"ph", "C"}, {"pid", process}};
        event["ts"] = microseconds(time);
        event["args"] = {{"rays", rays}};
        write(event);
    }
    /// No displayTimeUnit: some versions of Perfetto take it for the unit of the times, which are microseconds.
    void end() { out_ << "\n]}\n"; }

    /// Since the run began.
    double microseconds(std::int64_t time) const { return 1e-3 * static_cast<double>(time - start_); }

  private:
    void write(const Json& event) {
        out_ << (first_ ? "" : ",\n") << event.dump(-1, ' ', false, Json::error_handler_t::replace);
        first_ = false;
    }
    std::ostream& out_;
    std::int64_t start_;
    bool first_ = true;
};

void write_launch(Events& events, const Launch& l) {
    Json arguments = {{"items in", l.items_in},
                      {"items out", l.items_out},
                      {"work-groups", l.groups},
                      {"places", l.places},
                      {"bytes read", l.traffic.bytes_read},
                      {"bytes written", l.traffic.bytes_written},
                      {"atomics", l.traffic.atomics},
                      {"queued", events.microseconds(l.queued)},
                      {"submitted", events.microseconds(l.submitted)}};
    if (l.wave != no_wave) {
        arguments["depth"] = l.depth;
        arguments["wave"] = l.wave;
    }
    events.complete(device_track, stage_name(l.stage), l.started, l.ended, std::move(arguments));
}

/// What the queues hold, told from the launches: generate and secondary fill them, a wave begins with intersect.
class Fills {
  public:
    Fills(Events& events, std::size_t depths) : events_(events), rays_(depths, 0) {}

    void follow(const Launch& l) {
        if (l.stage == Stage::generate) add(l.depth, l.ended, static_cast<std::int64_t>(l.items_out));
        if (l.stage == Stage::intersect) add(l.depth, l.started, -static_cast<std::int64_t>(l.items_in));
        if (l.stage == Stage::secondary) add(l.depth + 1, l.ended, static_cast<std::int64_t>(l.items_out));
    }

  private:
    void add(int depth, std::int64_t time, std::int64_t rays) {
        std::int64_t& sum = rays_.at(static_cast<std::size_t>(depth));
        sum += rays;
        events_.fill(depth, time, sum);
    }
    Events& events_;
    std::vector<std::int64_t> rays_;
};

}  // namespace

void write_trace(std::ostream& out, const RunProfile& run) {
    Events events(out, run.start);
    events.name_process("raymill " + run.scene);
    events.name_track(host_track, "host");
    events.name_track(device_track, run.device);
    for (const Span& span : run.spans) events.complete(host_track, span.name, span.start, span.end, Json::object());
    Fills fills(events, run.frame.depths.size());
    for (const Launch& launch : run.frame.launches) {
        write_launch(events, launch);
        fills.follow(launch);
    }
    events.end();
}

}  // namespace raymill::profile
