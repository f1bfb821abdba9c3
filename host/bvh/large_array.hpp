// Memory for arrays of a million elements and more: not filled before use, and in huge pages where the system has them.
// The first touch of each small page costs a microsecond, which for a build that touches all of its memory once or
// twice was a sixth of its time.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "common/huge_pages.hpp"

namespace raymill::bvh {

/// Leaves elements that are made without arguments uninitialised.
template <typename T>
class LargeAllocator {
  public:
    using value_type = T;

    LargeAllocator() = default;
    template <typename U>
    LargeAllocator(const LargeAllocator<U>&) {}

    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        void* memory = ::operator new(bytes, alignment(bytes));
        ask_for_huge_pages(memory, bytes);
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) { ::operator delete(memory, alignment(count * sizeof(T))); }

    template <typename U>
    void construct(U* place) {
        ::new (static_cast<void*>(place)) U;
    }
    template <typename U, typename... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }

    bool operator==(const LargeAllocator&) const = default;

  private:
    static std::align_val_t alignment(std::size_t bytes) {
        return std::align_val_t{bytes >= HUGE_PAGE ? HUGE_PAGE : std::size_t{64}};
    }
};

template <typename T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace raymill::bvh
