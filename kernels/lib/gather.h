// Between records in memory and lanes. A record's words are taken four at a time: sixteen rows of four words become
// four columns of sixteen by eight shuffles, where sixteen loads a column would each fill one lane.
#ifndef RAYMILL_GATHER_H
#define RAYMILL_GATHER_H

#include "lib/lanes.h"

/// Four words of sixteen records.
typedef struct {
    float16 x, y, z, w;
} Lanes4;

/// The same, record by record: row i is words [4 i, 4 i + 4).
typedef struct {
    float16 part[4];
} Rows;

/// Four words of a record, which begin at a multiple of one word only.
typedef float4 Row __attribute__((aligned(4)));

/// Length of a record in words.
#define WORDS(Record) ((uint)(sizeof(Record) / 4))

static inline Lanes3 lanes_xyz(Lanes4 v) {
    const Lanes3 r = {v.x, v.y, v.z};
    return r;
}

/// Lanes 0, 2, 4 ... and 1, 3, 5 ... of two vectors end to end, and two vectors' lanes by turns: the first eight lanes
/// of each, and the last eight. One instruction each.
static inline float16 even_lanes(float16 a, float16 b) {
    return (float16)(a.s0, a.s2, a.s4, a.s6, a.s8, a.sa, a.sc, a.se, b.s0, b.s2, b.s4, b.s6, b.s8, b.sa, b.sc, b.se);
}
static inline float16 odd_lanes(float16 a, float16 b) {
    return (float16)(a.s1, a.s3, a.s5, a.s7, a.s9, a.sb, a.sd, a.sf, b.s1, b.s3, b.s5, b.s7, b.s9, b.sb, b.sd, b.sf);
}
static inline float16 first_by_turns(float16 a, float16 b) {
    return (float16)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7);
}
static inline float16 last_by_turns(float16 a, float16 b) {
    return (float16)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se, b.se, a.sf, b.sf);
}

static inline Lanes4 columns_of(Rows rows) {
    const float16* part = rows.part;
    const float16 xz_first = even_lanes(part[0], part[1]), xz_last = even_lanes(part[2], part[3]);
    const float16 yw_first = odd_lanes(part[0], part[1]), yw_last = odd_lanes(part[2], part[3]);
    const Lanes4 columns = {even_lanes(xz_first, xz_last), even_lanes(yw_first, yw_last), odd_lanes(xz_first, xz_last),
                            odd_lanes(yw_first, yw_last)};
    return columns;
}

static inline Rows rows_of(Lanes3 xyz, float16 w) {
    const float16 xz_first = first_by_turns(xyz.x, xyz.z), xz_last = last_by_turns(xyz.x, xyz.z);
    const float16 yw_first = first_by_turns(xyz.y, w), yw_last = last_by_turns(xyz.y, w);
    const Rows rows = {{first_by_turns(xz_first, yw_first), last_by_turns(xz_first, yw_first),
                        first_by_turns(xz_last, yw_last), last_by_turns(xz_last, yw_last)}};
    return rows;
}

static inline float4 row_of(const Rows* rows, uint lane) {
    return ((const float4*)rows)[lane];
}

static inline void store_row(global void* words, float4 row) {
    *(global Row*)words = row;
}

/// Four words of one record, in every lane.
static inline Lanes4 broadcast4(global const void* words) {
    const float4 row = *(global const Row*)words;
    const Lanes4 r = {(float16)(row.x), (float16)(row.y), (float16)(row.z), (float16)(row.w)};
    return r;
}

/// Four words of the records that `index` names, each `stride` words long. `words` are those of record 0.
static inline Lanes4 gather4(global const void* words, uint stride, uint16 index) {
    const uint* record = (const uint*)&index;
    Rows rows;
#pragma unroll
    for (uint lane = 0; lane < LANES; ++lane)
        ((float4*)&rows)[lane] = *(global const Row*)((global const float*)words + (ulong)record[lane] * stride);
    return columns_of(rows);
}

/// Four words of up to sixteen records in a row, of the last one again where there are fewer; `words` are those of the
/// first.
static inline Rows load_rows(global const void* words, uint stride, uint count) {
    Rows rows;
#pragma unroll
    for (uint lane = 0; lane < LANES; ++lane)
        ((float4*)&rows)[lane] = *(global const Row*)((global const float*)words + min(lane, count - 1) * stride);
    return rows;
}

/// Four words of sixteen records in a row.
static inline Lanes4 load4(global const void* words, uint stride) {
    return columns_of(load_rows(words, stride, LANES));
}

/// One word of the records.
static inline float16 gather1(global const void* word, uint stride, uint16 index) {
    const uint* record = (const uint*)&index;
    float16 values;
#pragma unroll
    for (uint lane = 0; lane < LANES; ++lane)
        ((float*)&values)[lane] = ((global const float*)word)[(ulong)record[lane] * stride];
    return values;
}

#endif
