#include "scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <span>
#include <thread>

#include "wavefront/renderer.hpp"

namespace raymill::bench {

namespace {

constexpr double smallest_scene = 1e4;  // triangles
constexpr double usual_scene = 1e6;
constexpr int smallest_queue_bits = 10;
constexpr int smallest_image_bits = 6;

/// All wanted sets of rays that are not empty, from what a peer that is built hits.
std::vector<RaySet> ray_sets(const BenchScene& bench, const EmbreeSide& embree, const MeasureOptions& options) {
    const RaySet camera = camera_rays(bench.scene.camera, options.width, options.height);
    std::vector<RaySet> sets = bounced_rays(bench, camera, embree.closest_hits(camera.rays));
    sets.insert(sets.begin(), camera);
    std::erase_if(sets, [&](const RaySet& set) { return set.rays.empty() || !options.wants(set.name); });
    return sets;
}

/// A thing to be timed, and the rays that it traces.
struct Work {
    std::function<void()> run;
    double rays = 1;
};

/// Median nanoseconds a ray, in rounds in which each work runs twice; the second time counts, when the caches hold what
/// the first left there.
std::vector<double> time_in_turn(const std::vector<Work>& works, int rounds, Clock clock) {
    std::vector<std::vector<double>> times(works.size());
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < works.size(); ++i) {
            works[i].run();
            times[i].push_back(1e9 * seconds_of(works[i].run, clock) / works[i].rays);
        }
    std::vector<double> medians;
    for (const auto& of_work : times) medians.push_back(quartiles(of_work).median);
    return medians;
}

std::string count_name(double count) {
    if (count >= 1e6) return fmt::format("{:g}M", count / 1e6);
    return fmt::format("{:g}k", count / 1e3);
}

Work trace_of(RaymillSide& side, const RaySet& set) {
    return {side.variants(set).front().trace, static_cast<double>(set.rays.size())};
}

/// Embree with hierarchies over a scene.
struct Peer : EmbreeSide {
    Peer(const BenchScene& bench, const MeasureOptions& options)
        : EmbreeSide(bench.scene, options.threads, options.robust) {
        for (const Quality quality : options.qualities) build(quality);
    }
};

std::vector<Work> traces_of(const EmbreeSide& embree, const RaySet& set) {
    std::vector<Work> works;
    for (const Variant& variant : embree.variants(set))
        works.push_back({variant.trace, static_cast<double>(set.rays.size())});
    return works;
}

/// A made scene, ready to be traced.
struct PreparedScene {
    PreparedScene(BenchScene made, const RaymillKernels& kernels, const MeasureOptions& options)
        : bench(std::move(made)),
          peer(bench, options),
          sets(ray_sets(bench, peer, options)),
          hierarchy(bench.scene, {options.threads, options.bvh}) {
        hierarchy.build();
        side.emplace(kernels, bench.scene, hierarchy.bvh());
    }
    /// Null where no ray is in the set.
    const RaySet* set(const std::string& name) const {
        const auto found = std::ranges::find(sets, name, &RaySet::name);
        return found == sets.end() ? nullptr : &*found;
    }

    BenchScene bench;
    Peer peer;
    std::vector<RaySet> sets;
    RaymillHierarchy hierarchy;  // the side may share its memory
    std::optional<RaymillSide> side;
};

ScalingTable by_scene(const Recipe& recipe, const ScalingOptions& options) {
    ScalingTable table{recipe.name + ": a ray by triangles", {}, "growth", LARGEST_GROWTH, false, {}};
    const RaymillKernels kernels(options.device, options.measure.threads, {Traversal::automatic});
    std::vector<std::unique_ptr<PreparedScene>> scenes;
    for (double triangles = smallest_scene; triangles <= options.largest; triangles *= 10) {
        table.columns.push_back(count_name(triangles));
        scenes.push_back(std::make_unique<PreparedScene>(recipe.make(triangles), kernels, options.measure));
    }
    for (const RaySet& set : scenes.front()->sets) {
        std::vector<Work> works;
        for (const auto& scene : scenes)
            if (const RaySet* same = scene->set(set.name)) works.push_back(trace_of(*scene->side, *same));
        if (works.size() < scenes.size()) continue;
        const std::size_t ours = works.size();
        for (const PreparedScene* scene : {scenes.front().get(), scenes.back().get()})
            for (Work& work : traces_of(scene->peer, *scene->set(set.name))) works.push_back(std::move(work));
        const std::vector<double> times = time_in_turn(works, options.measure.rounds, options.measure.clock);
        const std::size_t calls = (times.size() - ours) / 2;
        const auto fastest = [&](std::size_t first) {
            return std::ranges::min(std::span(times).subspan(first, calls));
        };
        ScalingRow row{set.name, {times.begin(), times.begin() + static_cast<std::ptrdiff_t>(ours)}, 1};
        row.factor = row.nanoseconds.back() / row.nanoseconds.front();
        row.embree_factor = fastest(ours + calls) / fastest(ours);
        table.rows.push_back(row);
    }
    return table;
}

ScalingTable by_threads(const Recipe& recipe, const ScalingOptions& options, const BenchScene& bench, unsigned most) {
    std::vector<unsigned> counts;
    for (unsigned threads = 1; threads < most; threads *= 2) counts.push_back(threads);
    counts.push_back(most);
    ScalingTable table{recipe.name + ": a ray by threads", {}, "speed-up", SMALLEST_SPEED_UP * most, true, {}};

    RaymillHierarchy hierarchy(bench.scene, {options.measure.threads, options.measure.bvh});
    hierarchy.build();
    std::vector<std::unique_ptr<RaymillKernels>> kernels;
    std::vector<std::unique_ptr<RaymillSide>> sides;
    for (const unsigned threads : counts) {
        table.columns.push_back(fmt::format("{}", threads));
        kernels.push_back(std::make_unique<RaymillKernels>(options.device, threads, std::vector{Traversal::automatic}));
        sides.push_back(std::make_unique<RaymillSide>(*kernels.back(), bench.scene, hierarchy.bvh()));
    }
    for (const RaySet& set : ray_sets(bench, Peer(bench, options.measure), options.measure)) {
        std::vector<Work> works;
        for (const auto& side : sides) works.push_back(trace_of(*side, set));
        ScalingRow row{set.name, time_in_turn(works, options.measure.rounds, Clock::wall), 1};
        row.factor = row.nanoseconds.front() / row.nanoseconds.back();
        table.rows.push_back(row);
    }
    return table;
}

/// Frames of the scene with a light where the lamp is, and one reflection.
Scene frame_scene(const BenchScene& bench, int width, int height) {
    Scene scene = bench.scene;
    SceneLight light;
    light.light = PointLight{bench.lamp.position};
    scene.lights = {light};
    scene.materials.front().reflection = 0.25f;
    scene.settings.depth = 1;
    scene.settings.width = width;
    scene.settings.height = height;
    return scene;
}

/// A frame and all that it needs.
struct FrameWork {
    FrameWork(const Device& device, Scene made, const Bvh& bvh, std::uint64_t queue_capacity)
        : scene(std::move(made)), renderer(device, scene, bvh, options(queue_capacity)) {}

    static RenderOptions options(std::uint64_t queue_capacity) {
        RenderOptions options;
        options.memory.queue_capacity = queue_capacity;
        return options;
    }
    Work work() {
        return {[this] { renderer.render(); }, static_cast<double>(renderer.render().rays.total())};
    }

    Scene scene;
    Renderer renderer;
};

/// A row for each power of two: its neighbours and itself, whose spread is the factor, and what else is compared.
ScalingRow row_of(int bits, std::vector<std::unique_ptr<FrameWork>> frames, const MeasureOptions& options) {
    std::vector<Work> works;
    for (const auto& frame : frames) works.push_back(frame->work());
    ScalingRow row{fmt::format("2^{}", bits), time_in_turn(works, options.rounds, options.clock), 1};
    const auto [fastest, slowest] = std::ranges::minmax(std::span(row.nanoseconds).first(3));
    row.factor = slowest / fastest;
    return row;
}

ScalingTable by_queue(const Recipe& recipe, const ScalingOptions& options, const BenchScene& bench,
                      const Device& device, const Bvh& bvh) {
    const MeasureOptions& m = options.measure;
    ScalingTable table{
        recipe.name + ": a ray by queue capacity", {"-1", "0", "+1", "default"}, "step", LARGEST_STEP, false, {}};
    const auto pixels = static_cast<unsigned>(m.width) * static_cast<unsigned>(m.height);
    for (int bits = smallest_queue_bits; bits < static_cast<int>(std::bit_width(pixels)); ++bits) {
        std::vector<std::unique_ptr<FrameWork>> frames;
        const auto power = std::uint64_t{1} << bits;
        // The default beside each: rows are measured minutes apart, and the machine may be busier by then.
        for (const std::uint64_t capacity : {power - 1, power, power + 1, std::uint64_t{0}})
            frames.push_back(std::make_unique<FrameWork>(device, frame_scene(bench, m.width, m.height), bvh, capacity));
        table.rows.push_back(row_of(bits, std::move(frames), m));
    }
    return table;
}

ScalingTable by_image(const Recipe& recipe, const ScalingOptions& options, const BenchScene& bench,
                      const Device& device, const Bvh& bvh) {
    ScalingTable table{
        recipe.name + ": a ray by edge of a square image", {"-1", "0", "+1"}, "step", LARGEST_STEP, false, {}};
    const int widest = 2 * std::max(options.measure.width, options.measure.height);
    for (int bits = smallest_image_bits; 1 << bits <= widest; ++bits) {
        std::vector<std::unique_ptr<FrameWork>> frames;
        for (const int beside : {-1, 0, 1}) {
            const int edge = (1 << bits) + beside;
            frames.push_back(std::make_unique<FrameWork>(device, frame_scene(bench, edge, edge), bvh, 0));
        }
        table.rows.push_back(row_of(bits, std::move(frames), options.measure));
    }
    return table;
}

}  // namespace

void measure_scaling(const Recipe& recipe, const ScalingOptions& options,
                     const std::function<void(const ScalingTable&)>& done) {
    done(by_scene(recipe, options));
    const BenchScene bench = recipe.make(std::min(options.largest, usual_scene));
    const unsigned most = options.measure.threads > 0 ? options.measure.threads : std::thread::hardware_concurrency();
    if (most > 1) done(by_threads(recipe, options, bench, most));
    const Device device = open_device(options.device, options.measure.threads);
    RaymillHierarchy hierarchy(bench.scene, {options.measure.threads, options.measure.bvh});
    hierarchy.build();
    done(by_queue(recipe, options, bench, device, hierarchy.bvh()));
    done(by_image(recipe, options, bench, device, hierarchy.bvh()));
}

}  // namespace raymill::bench
