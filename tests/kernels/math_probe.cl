// The elementary functions of lib/math.h, lib/lanes.h and lib/random.h, item by item.

#include "lib/sampling.h"

/// Four words of output an item. selector names the function; a and b are its arguments as bits.
kernel void math_probe(global const uint* a, global const uint* b, uint items, uint selector, global uint* out) {
    const uint i = get_global_id(0);
    if (i >= items) return;
    const float x = as_float(a[i]), y = as_float(b[i]);
    float4 r = (float4)(0.0f);
    if (selector == 0) r.x = lanes_exp2((float16)(x)).s0;
    if (selector == 1) r.x = lanes_log2((float16)(x)).s0;
    if (selector == 2) r.x = lanes_power((float16)(x), (float16)(y)).s0;
    if (selector == 3)
        r.xyz = (float3)(lanes_exp_minus((float16)(x)).s0, lanes_exp_minus((float16)(y)).s0,
                         lanes_exp_minus((float16)(0.0f)).s0);
    float16 first, second;
    if (selector == 4) {
        lanes_cos_sin((float16)(x), &first, &second);
        r.xy = (float2)(first.s0, second.s0);
    }
    if (selector == 5) r.x = lanes_angle((float16)(y), (float16)(x)).s0;
    if (selector == 6) {
        lanes_disk((float16)(x), (float16)(y), &first, &second);
        r.xy = (float2)(first.s0, second.s0);
    }
    vstore4(as_uint4(r), i, out);
}

/// Eight words of output an item: the two tangents of a unit normal (x, y, z).
kernel void tangents_probe(global const uint* x, global const uint* y, global const uint* z, uint items, uint selector,
                           global uint* out) {
    const uint i = get_global_id(0);
    if (i >= items || selector != 0) return;
    const Lanes3 n = lanes_of((float3)(as_float(x[i]), as_float(y[i]), as_float(z[i])));
    Lanes3 t, u;
    lanes_tangents(n, &t, &u);
    vstore4(as_uint4((float4)(t.x.s0, t.y.s0, t.z.s0, 0.0f)), 2 * i, out);
    vstore4(as_uint4((float4)(u.x.s0, u.y.s0, u.z.s0, 0.0f)), 2 * i + 1, out);
}

/// Two words of output an item: stratified_point of (index, key).
kernel void stratified_probe(global const uint* index, global const uint* key, uint items, uint selector,
                             global uint* out) {
    const uint i = get_global_id(0);
    if (i >= items || selector != 0) return;
    uint16 x, y;
    stratified_point((uint16)(index[i]), (uint16)(key[i]), &x, &y);
    out[2 * i] = x.s0;
    out[2 * i + 1] = y.s0;
}
