#include "cli/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "common/child_process.hpp"

namespace raymill {

namespace {

/// The whole text as a number, or nothing.
template <class Number>
std::optional<Number> number(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

const std::map<std::string, Traversal>& traversals() {
    static const std::map<std::string, Traversal> names = {
        {"auto", Traversal::automatic}, {"packet", Traversal::packet}, {"single", Traversal::single}};
    return names;
}

/// Another process of this program that compiles kernels for what `arguments` choose; empty if there can be none.
std::vector<std::string> helper_command(const DeviceArguments& arguments) {
    const std::string program = this_program();
    if (program.empty()) return {};
    std::vector<std::string> command = {program, "compile"};
    const auto add = [&](const char* flag, const std::string& value) { command.insert(command.end(), {flag, value}); };
    for (const profile::Stage stage : compile_helper_stages) add("--stages", std::string(profile::stage_name(stage)));
    if (!arguments.device.empty()) add("--device", arguments.device);
    if (!arguments.kernel_dir.empty()) add("--kernel-dir", arguments.kernel_dir);
    if (arguments.threads > 0) add("--threads", std::to_string(arguments.threads));
    if (arguments.work_group > 0) add("--work-group", std::to_string(arguments.work_group));
    for (const auto& [name, traversal] : traversals())
        if (traversal == arguments.traversal) add("--traversal", name);
    return command;
}

/// One number of a CountFlag, or nothing where it makes no sense.
std::optional<std::uint32_t> count(std::string_view text, const CountFlag& flag) {
    if (!flag.word.empty() && text == flag.word) return 0;
    const std::size_t units = std::string_view("kKmM").find(text.empty() ? ' ' : text.back());
    const int shift = units == std::string_view::npos ? 0 : units < 2 ? 10 : 20;
    if (shift > 0) text.remove_suffix(1);
    const auto value = number<std::uint64_t>(text);
    if (!value || *value < 1 || *value > flag.largest || *value << shift > flag.largest) return std::nullopt;
    return static_cast<std::uint32_t>(*value << shift);
}

std::string range_text(const CountFlag& flag) {
    return fmt::format("1 to {}{}", flag.largest, flag.word.empty() ? "" : " or " + flag.word);
}

}  // namespace

std::pair<int, int> parse_size(const std::string& text) {
    const auto parts = split(text, 'x');
    if (parts.size() == 2) {
        const auto width = number<int>(parts[0]), height = number<int>(parts[1]);
        if (width && height && *width >= 1 && *height >= 1 && *width <= largest_side && *height <= largest_side)
            return {*width, *height};
    }
    throw UsageError(
        fmt::format("--size {}: give width and height in pixels, 1 to {}, as in 640x480", text, largest_side));
}

Crop parse_crop(const std::string& text) {
    const auto parts = split(text, ',');
    double values[4] = {0, 0, 0, 0};
    bool valid = parts.size() == 4;
    for (std::size_t i = 0; valid && i < 4; ++i) {
        const auto value = number<double>(parts[i]);
        valid = value && *value >= 0 && *value <= 1;
        if (valid) values[i] = *value;
    }
    if (!valid || values[0] >= values[1] || values[2] >= values[3])
        throw UsageError(
            fmt::format("--crop {}: give four fractions x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1, as "
                        "in 0.25,0.75,0,1",
                        text));
    return {values[0], values[1], values[2], values[3]};
}

std::uint64_t parse_bytes(const std::string& text) {
    const std::size_t digits = text.find_first_not_of("0123456789.");
    const auto value = number<double>(std::string_view(text).substr(0, digits));
    std::string unit = digits == std::string::npos ? "" : text.substr(digits);
    for (const char* suffix : {"iB", "B"})
        if (unit.ends_with(suffix)) unit.resize(unit.size() - std::string_view(suffix).size());
    const std::string_view units = "KMGT";
    const std::size_t power = unit.empty() ? 0 : units.find(unit[0]) + 1;
    const double bytes = value ? *value * std::pow(1024.0, static_cast<double>(power)) : 0;
    if (!value || unit.size() > 1 || (!unit.empty() && power == 0) || !(bytes >= 1) || bytes > 1e18)
        throw UsageError(fmt::format("--mem-limit {}: give a size in bytes, as in 512M or 2G", text));
    return static_cast<std::uint64_t>(bytes);
}

void check_keeps(const std::string& input, const std::string& output) {
    std::error_code missing;
    if (std::filesystem::equivalent(input, output, missing))
        throw UsageError(fmt::format("{} is what this reads: choose another file to write", output));
}

void CountFlag::add_to(CLI::App& command, std::uint32_t& value, const std::string& description) const {
    command
        .add_option_function<std::string>(
            name, [flag = *this, &value](const std::string& text) { value = flag.parse(text); }, description)
        ->type_name(word.empty() ? "N" : "N|" + word);
}

std::uint32_t CountFlag::parse(const std::string& text) const {
    const auto value = count(text, *this);
    if (!value)
        throw UsageError(fmt::format("{} {}: give a number from {}, as in 64 or 16k", name, text, range_text(*this)));
    return *value;
}

std::vector<std::uint32_t> CountFlag::parse_list(const std::string& list) const {
    std::vector<std::uint32_t> counts;
    for (const std::string_view item : split(list, ',')) {
        const auto value = count(item, *this);
        if (!value)
            throw UsageError(fmt::format("{} {}: give numbers from {}, with commas between them, as in 1k,64k,1M", name,
                                         list, range_text(*this)));
        counts.push_back(*value);
    }
    std::ranges::sort(counts);
    const auto repeated = std::ranges::unique(counts);
    counts.erase(repeated.begin(), repeated.end());
    return counts;
}

CLI::Option* SceneArguments::add_to(CLI::App& command) {
    CLI::Option* const scene =
        command.add_option("SCENE", file, "Scene file (.toml) or bare model (.obj, .ply, .gltf, .glb)")->required();
    command.add_option("--size", size, "Image size in pixels, as in 640x480")->type_name("WxH");
    command.add_option("--spp", spp, "Samples per pixel, stratified")->type_name("N")->check(CLI::Range(1, 1 << 20));
    command.add_option("--depth", depth, "Recursion limit; 0 is local illumination with shadows")
        ->type_name("N")
        ->check(CLI::Range(0, 1000));
    command.add_option("--integrator", integrator, "whitted")->type_name("NAME");
    command.add_option("--crop", crop, "Render only this window, in fractions of the image")->type_name("x0,x1,y0,y1");
    command.add_option("--seed", seed, "Seed of the random numbers")->type_name("N");
    command.add_option("--exposure", exposure, "Stops by which a PNG is brightened")->type_name("F");
    return scene;
}

bool SceneArguments::has_overrides() const {
    return !size.empty() || spp || depth || !integrator.empty() || !crop.empty() || seed || exposure;
}

Scene SceneArguments::load() const {
    std::pair<int, int> pixels{0, 0};
    std::optional<Crop> window;
    if (!size.empty()) pixels = parse_size(size);
    if (!crop.empty()) window = parse_crop(crop);
    if (exposure && !(std::abs(*exposure) <= 100)) throw UsageError("--exposure: give stops from -100 to 100");
    if (!integrator.empty() && integrator != "whitted")
        throw UsageError(fmt::format("--integrator {}: this version has the integrator whitted", integrator));

    Scene scene = load_scene(file);
    RenderSettings& settings = scene.settings;
    if (!size.empty()) std::tie(settings.width, settings.height) = pixels;
    if (spp) settings.spp = *spp;
    if (depth) settings.depth = *depth;
    if (seed) settings.seed = *seed;
    if (exposure) settings.exposure = *exposure;
    if (window) settings.crop = *window;
    const PixelWindow rendered = crop_window(settings);
    if (rendered.width < 1 || rendered.height < 1)
        throw UsageError(
            fmt::format("--crop {}: no pixel of the {} x {} image lies in it", crop, settings.width, settings.height));
    return scene;
}

void DeviceArguments::add_to(CLI::App& command) {
    add_without_memory_to(command);
    add_memory_to(command);
}

void DeviceArguments::add_memory_to(CLI::App& command) {
    command.add_option("--mem-limit", mem_limit, "Device memory that may be used, as in 512M")->type_name("SIZE");
}

void DeviceArguments::add_pipelines_to(CLI::App& command) {
    command.add_option("--pipelines", pipelines, "Waves at once, at most; the image does not depend on it")
        ->type_name("N")
        ->check(CLI::Range(1, 16))
        ->capture_default_str();
}

void DeviceArguments::add_without_memory_to(CLI::App& command) {
    add_what_never_varies_to(command);
    threads_flag.add_to(command, threads, "Compute units to use, and threads that build and write; all by default");
    queue_capacity_flag.add_to(command, queue_capacity,
                               "Rays of a batch, as in 16k; k is 1024, M 1024 k; the image does not depend on it");
    work_group_flag.add_to(
        command, work_group,
        "Work-items of a group; auto (default) is what suits each stage; the image does not depend on it");
}

void DeviceArguments::add_fixed_to(CLI::App& command) {
    add_what_never_varies_to(command);
    add_memory_to(command);
}

void DeviceArguments::add_what_never_varies_to(CLI::App& command) {
    command.add_option("--device", device, "Device by index or part of its name; `raymill devices` lists them")
        ->type_name("INDEX|NAME");
    command
        .add_option("--traversal", traversal,
                    "auto, packet (coherent rays together) or single; the image does not depend on it")
        ->type_name("NAME")
        ->transform(CLI::CheckedTransformer(traversals()).description(""));
    static const std::map<std::string, BvhQuality> qualities = {{"fast", BvhQuality::fast}, {"high", BvhQuality::high}};
    command
        .add_option("--bvh", bvh,
                    "high (default) or fast: how long to build the hierarchy; the image does not depend on it")
        ->type_name("NAME")
        ->transform(CLI::CheckedTransformer(qualities).description(""));
    command.add_option("--kernel-dir", kernel_dir, "Read the kernels from this folder instead of the program")
        ->type_name("DIR");
}

RenderOptions DeviceArguments::options() const {
    RenderOptions options;
    options.memory.queue_capacity = queue_capacity;
    if (!mem_limit.empty()) options.memory.limit = parse_bytes(mem_limit);
    options.memory.pipelines = pipelines;
    options.work_group = work_group;
    options.traversal = traversal;
    options.kernel_dir = kernel_dir;
    options.compile_helper = helper_command(*this);
    return options;
}

}  // namespace raymill
