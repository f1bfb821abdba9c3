// Every struct and constant that crosses the border between the host and the kernels.
// Compiled by C++20 and by OpenCL C 1.2: scalars and fixed arrays only, so that both lay it out alike;
// tests/kernels/layout_test.cpp compares each offset with what the device says.
#ifndef RAYMILL_LAYOUT_H
#define RAYMILL_LAYOUT_H

#ifdef __OPENCL_VERSION__
#define RAYMILL_ASSERT_SIZE(type, bytes) typedef char type##_size_is[(sizeof(type) == (bytes)) ? 1 : -1]
#else
#include <cstdint>
#define RAYMILL_ASSERT_SIZE(type, bytes) static_assert(sizeof(type) == (bytes))
namespace raymill {
using uint = std::uint32_t;
using ulong = std::uint64_t;
#endif

// ---------------------------------------------------------------------------------------------
// Constants. An enum rather than macros: both languages scope and type it.

enum {
    BVH_WIDTH = 8,        // children of a node, and primitives in a leaf block
    CHUNK = 64,           // queue items that one work-item of a chunked stage owns
    FAMILY = 4 * CHUNK,   // that one of `secondary` owns where rays are traced together
    TILE = 8,             // camera samples are generated in tiles of TILE x TILE pixels
    SHADOW_SAMPLES = 4,   // light samples per hit that one shade / shadow pass handles at most
    FILM_CHANNELS = 4,    // of a plane: R, G, B, and one more that its plane explains
    FILM_FRACTION_BITS = 32  // the film counts in units of 2^-32
};

// Planes of the film. Only the beauty is always there; SceneConstants::plane says where the others lie.
enum {
    FILM_BEAUTY = 0,  // R, G, B, coverage
    // The lecture's picture: these six add up to the beauty, to the last integer. The first four are those of camera hits;
    // what secondary rays bring home belongs to the branch that the path took first. The background counts as emission.
    FILM_AMBIENT,
    FILM_DIFFUSE,
    FILM_SPECULAR,
    FILM_EMISSION,
    FILM_REFLECTION,
    FILM_REFRACTION,
    // Of camera hits:
    FILM_ALBEDO,
    FILM_NORMAL,    // x, y, z of the shading normal that faces the camera
    FILM_POSITION,  // x, y, z in world space, distance along the viewing axis
    FILM_SHADOW,    // share of each channel that reaches the hit, summed over light samples; number of light samples
    FILM_IDS,       // object + 1 and material + 1 of sample 0, largest depth, samples: plain integers
    FILM_PLANES
};

// Argument `film_flags` of the kernels that write the film.
#define FILM_PIXELS_ONCE 1u  // no two items that run have the same pixel, so that plain adds do
#define FILM_COUNTED 2u      // the frame is profiled: see Counters
#define FILM_PASS_SHIFT 2u   // from here on: which of the buffer's Counters the launch adds to

// A single contribution to the film is cut at this radiance; sums may reach 2^31.
#define FILM_LIMIT 16777216.0f
#define FILM_ONE 0x100000000l

#define NO_INDEX 0xffffffffu  // no primitive, texture, material or vertex normal

// A child word of BvhNode: 0 is an empty slot (the root is never a child); an inner node is its index; a leaf has
// CHILD_LEAF set, its first block in the low bits, and the number of further blocks in CHILD_BLOCKS.
#define CHILD_LEAF 0x80000000u
#define CHILD_SPHERES 0x40000000u    // the leaf's blocks are SphereBlocks, else TriangleBlocks
#define CHILD_BLOCKS_SHIFT 27u       // three bits: number of blocks minus one
#define CHILD_BLOCKS_MASK 7u
#define CHILD_FIRST_MASK 0x07ffffffu

// Ray::route: which secondary branch the path took first; it decides the AOV that its light belongs to.
#define ROUTE_CAMERA 0u
#define ROUTE_REFLECTED 1u
#define ROUTE_REFRACTED 2u

// Material::flags
#define MATERIAL_BLINN 1u          // highlight = "blinn"
#define MATERIAL_FLAT 2u           // shading = "flat"
#define MATERIAL_GOURAUD 4u        // shading = "gouraud"
#define MATERIAL_FRESNEL 8u        // fresnel = true
#define MATERIAL_CHECKER 16u       // diffuse_checker
#define MATERIAL_ABSORBING 32u     // absorption is not zero
#define MATERIAL_ONE_SIDED 64u     // emits on the side of the geometric normal only

// LightRecord::type; ambient and environment lights are folded into SceneConstants.
#define LIGHT_POINT 0u
#define LIGHT_DIRECTIONAL 1u
#define LIGHT_SPOT 2u
#define LIGHT_RECTANGLE 3u
#define LIGHT_DISK 4u
#define LIGHT_SPHERE 5u

// SceneConstants::shadows
#define SHADOWS_FILTERED 0u
#define SHADOWS_OPAQUE 1u
#define SHADOWS_NONE 2u

// ---------------------------------------------------------------------------------------------
// Geometry

/// A mesh vertex in world space. A zero normal means the faces that use it are flat.
typedef struct {
    float position[3];
    float normal[3];
    float uv[2];
} Vertex;

/// A triangle: its primitive id is its index. Counter-clockwise seen from outside.
typedef struct {
    uint vertex[3];
    uint material;
    uint object;
} Triangle;

/// A sphere: its primitive id is the number of triangles plus its index. World space; radius > 0.
typedef struct {
    float center[3];
    float radius;
    uint material;
    uint object;
} Sphere;

/// An infinite plane: its primitive id is the number of triangles and spheres plus its index. Unit normal.
typedef struct {
    float point[3];
    float normal[3];
    uint material;
    uint object;
} Plane;

/// Eight children as structure of arrays: bounds[0] lower and [1] upper planes per axis. Empty slots hold lower = +inf,
/// upper = -inf, which no ray hits. 256 bytes: four cache lines.
typedef struct {
    float bounds[2][3][BVH_WIDTH];
    uint child[BVH_WIDTH];
    uint unused[BVH_WIDTH];
} BvhNode;

/// Eight triangles, position[vertex][axis][lane]. Unused lanes repeat one point (zero area) and have NO_INDEX.
typedef struct {
    float position[3][3][BVH_WIDTH];
    uint primitive[BVH_WIDTH];
} TriangleBlock;

/// Eight spheres. Unused lanes have radius 0, which no ray hits, and NO_INDEX.
typedef struct {
    float center[3][BVH_WIDTH];
    float radius[BVH_WIDTH];
    uint primitive[BVH_WIDTH];
} SphereBlock;

// ---------------------------------------------------------------------------------------------
// Queue items

/// A camera or secondary ray. direction is unit; throughput weighs what the ray brings home.
/// path keys its random numbers: a hash chain of the seed, the pixel and the branches taken (lib/random.h).
typedef struct {
    float origin[3];
    uint pixel;  // index into the film, row by row from the top left of the rendered window
    float direction[3];
    uint sample;  // in [0, spp)
    float throughput[3];
    uint path;
    uint route;
} Ray;

/// The closest hit of the ray in the same slot. u and v weigh vertices 1 and 2 of a triangle.
typedef struct {
    float t;  // distance along the ray's direction
    float u;
    float v;
    uint primitive;  // NO_INDEX: the ray missed
} Hit;

/// A shadow ray, and what it adds to its pixel if nothing is in the way. direction is unit;
/// t_max is the distance to the light sample, infinite for directional lights.
typedef struct {
    float origin[3];
    float t_max;
    float direction[3];
    uint pixel;
    float diffuse[3];
    uint route;
    float specular[3];
    uint light;
} ShadowRay;

// ---------------------------------------------------------------------------------------------
// Constants of a frame

/// Linear RGB coefficients of lecture's local illumination, and the split into secondary rays.
typedef struct {
    float ambient[3];
    float shininess;
    float diffuse[3];
    float reflection;
    float specular[3];
    float transmission;
    float emission[3];
    float ior;  // inside
    float base_color[3];
    float exterior_ior;
    float absorption[3];  // per unit length
    float checker_scale;  // edge of a checker cell, world units
    float checker[3];     // diffuse colour of the odd cells; the even ones have `diffuse`
    uint diffuse_texture;  // index into the textures, or NO_INDEX
    uint flags;
} Material;

/// RGB float texels from texel `first` on, row by row from the top, linear RGB; repeats, bilinear.
typedef struct {
    uint first;
    uint width;
    uint height;
} Texture;

/// One light of any type; a field's meaning by type:
///   position: point, spot, and the centre of an area light
///   normal:   direction light travels (directional, spot), unit; the shining side (rectangle, disk)
///   axis_u, axis_v: full edges (rectangle); radius-long tangents (disk)
///   intensity: radiant intensity, irradiance, or radiance (area lights)
typedef struct {
    float position[3];
    uint type;
    float normal[3];
    float radius;  // ball of a point light; sphere light
    float axis_u[3];
    float area;  // rectangle and disk
    float axis_v[3];
    uint samples;
    float intensity[3];
    float cone_scale;  // spot: clamp(cos * scale + offset, 0, 1)^2
    float attenuation[3];
    float cone_offset;
} LightRecord;

/// One entry a light sample, lights in order: shade passes take consecutive ranges of this list.
typedef struct {
    uint light;
    uint sample;  // in [0, LightRecord::samples)
} LightSlot;

/// Camera in world space; the film plane lies at unit distance (perspective) or through the eye (orthographic).
typedef struct {
    float eye[3];
    float lens_radius;
    float forward[3];  // unit
    float focus;       // distance to the plane in focus along forward
    float right[3];    // half the film plane's width long
    uint orthographic;
    float up[3];       // half its height long
    uint width;        // of the whole image in pixels
    uint height;
    uint crop[4];      // x0, y0, width, height of the rendered window in pixels
    uint spp;
    uint seed;
} CameraRecord;

// Counters::atomics, by kernel.
enum { ATOMICS_INTERSECT, ATOMICS_SHADE, ATOMICS_SHADOW, ATOMICS_FEATURES, ATOMICS_SECONDARY, ATOMICS_KERNELS };

/// What a wave tells the host, and what the film saw. 64-bit: added to by any number of work-items.
typedef struct {
    ulong children;          // rays that `secondary` was asked to push in this wave
    ulong shadow_rays;       // shadow rays that `shade` has pushed since the start
    ulong shadow_traced;     // of these, how many `shadow` has taken
    ulong shadow_blocked;    // shadow rays that brought nothing
    ulong saturated;         // film contributions cut to FILM_LIMIT, or sums that overflowed
    ulong not_a_number;      // film contributions left out
    // Since the start, where the frame is profiled:
    ulong missed;            // rays without a hit
    ulong passing;           // hits on surfaces that pass light on
    ulong parents;           // hits that `secondary` found children of
    ulong atomics[ATOMICS_KERNELS];  // atomic operations on the film and on the six counters above
} Counters;

/// What every shading stage needs to know of the scene beside its arrays.
typedef struct {
    float background[3];  // radiance of rays that miss, constant environments included
    uint triangle_count;
    float ambient[3];  // sum of the ambient lights
    uint sphere_count;
    uint plane_count;
    uint node_count;      // 0: nothing but planes
    uint shadows;
    uint robust_offset;  // 0: rays start exactly at the hit, to show the acne
    float min_weight;
    uint any_filter;      // some material transmits: a filtered shadow ray may pass through
    uint environment;     // index of the lat-long texture that rays see when they miss, or NO_INDEX
    float environment_scale[3];
    uint plane[FILM_PLANES];   // where each plane lies in the film, in planes; 0: not kept (but for the beauty)
    uint film_pixels;          // of a plane
} SceneConstants;

RAYMILL_ASSERT_SIZE(Vertex, 32);
RAYMILL_ASSERT_SIZE(Triangle, 20);
RAYMILL_ASSERT_SIZE(Sphere, 24);
RAYMILL_ASSERT_SIZE(Plane, 32);
RAYMILL_ASSERT_SIZE(BvhNode, 256);
RAYMILL_ASSERT_SIZE(TriangleBlock, 320);
RAYMILL_ASSERT_SIZE(SphereBlock, 160);
RAYMILL_ASSERT_SIZE(Ray, 52);
RAYMILL_ASSERT_SIZE(Hit, 16);
RAYMILL_ASSERT_SIZE(ShadowRay, 64);
RAYMILL_ASSERT_SIZE(Material, 116);
RAYMILL_ASSERT_SIZE(Texture, 12);
RAYMILL_ASSERT_SIZE(LightRecord, 96);
RAYMILL_ASSERT_SIZE(LightSlot, 8);
RAYMILL_ASSERT_SIZE(CameraRecord, 92);
RAYMILL_ASSERT_SIZE(Counters, 112);
RAYMILL_ASSERT_SIZE(SceneConstants, 124);

#ifndef __OPENCL_VERSION__
}  // namespace raymill
#endif

#endif
