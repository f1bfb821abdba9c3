// Says how the device lays out the structs of layout.h.

#include "layout.h"

#define STRUCT(type) out[i++] = sizeof(type);
#define MEMBER(type, member)                          \
    out[i++] = (uint)(ulong)&((global type*)0)->member; \
    out[i++] = sizeof(((global type*)0)->member);

/// One work-item: the size of each struct, then offset and size of each of its members, in the order of layout_members.h.
kernel void layout_probe(uint items, uint selector, global uint* out) {
    uint i = 0;
    if (items == 0 || selector != 0) return;
#include "../tests/kernels/layout_members.h"
}
