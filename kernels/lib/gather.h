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

static inline Lanes4 columns_of(Rows rows) {
    const float16 xz_lo = (float16)(rows.part[0].even, rows.part[1].even);
    const float16 xz_hi = (float16)(rows.part[2].even, rows.part[3].even);
    const float16 yw_lo = (float16)(rows.part[0].odd, rows.part[1].odd);
    const float16 yw_hi = (float16)(rows.part[2].odd, rows.part[3].odd);
    const Lanes4 columns = {(float16)(xz_lo.even, xz_hi.even), (float16)(yw_lo.even, yw_hi.even),
                            (float16)(xz_lo.odd, xz_hi.odd), (float16)(yw_lo.odd, yw_hi.odd)};
    return columns;
}

static inline Rows rows_of(Lanes3 xyz, float16 w) {
    float16 xz_lo, xz_hi, yw_lo, yw_hi;
    xz_lo.even = xyz.x.lo;
    xz_lo.odd = xyz.z.lo;
    xz_hi.even = xyz.x.hi;
    xz_hi.odd = xyz.z.hi;
    yw_lo.even = xyz.y.lo;
    yw_lo.odd = w.lo;
    yw_hi.even = xyz.y.hi;
    yw_hi.odd = w.hi;
    Rows rows;
    rows.part[0].even = xz_lo.lo;
    rows.part[0].odd = yw_lo.lo;
    rows.part[1].even = xz_lo.hi;
    rows.part[1].odd = yw_lo.hi;
    rows.part[2].even = xz_hi.lo;
    rows.part[2].odd = yw_hi.lo;
    rows.part[3].even = xz_hi.hi;
    rows.part[3].odd = yw_hi.hi;
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

/// Four words of sixteen records in a row; `words` are those of the first.
static inline Lanes4 load4(global const void* words, uint stride) {
    Rows rows;
#pragma unroll
    for (uint lane = 0; lane < LANES; ++lane)
        ((float4*)&rows)[lane] = *(global const Row*)((global const float*)words + lane * stride);
    return columns_of(rows);
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
