// Typed device memory.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "device/device.hpp"

namespace raymill {

/// `size` elements of T on the device. An empty buffer still owns one element, so that it may be passed to a kernel.
template <class T>
class Buffer {
  public:
    Buffer() = default;
    Buffer(const Device& device, std::size_t size)
        : size_(size), memory_(device.context, CL_MEM_READ_WRITE, std::max<std::size_t>(size, 1) * sizeof(T)) {}
    Buffer(const Device& device, std::span<const T> values) : Buffer(device, values.size()) { write(device, values); }

    /// The elements of `values`, which must not be empty and must outlive the buffer: a device that is this processor
    /// works in their memory itself. They are what the device wrote after read_back().
    static Buffer over(const Device& device, std::span<T> values) {
        Buffer buffer;
        buffer.size_ = values.size();
        buffer.memory_ =
            cl::Buffer(device.context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, values.size_bytes(), values.data());
        return buffer;
    }
    void read_back(const Device& device) const {
        void* values = device.queue.enqueueMapBuffer(memory_, CL_TRUE, CL_MAP_READ, 0, size_ * sizeof(T));
        device.queue.enqueueUnmapMemObject(memory_, values);
        device.queue.finish();
    }

    /// The first `count` elements in the same memory, as a buffer of their own.
    Buffer first(std::size_t count) const {
        Buffer part = *this;
        part.size_ = count;
        return part;
    }

    std::size_t size() const { return size_; }
    const cl::Buffer& memory() const { return memory_; }

    void write(const Device& device, std::span<const T> values, std::size_t first = 0) {
        if (values.empty()) return;
        device.queue.enqueueWriteBuffer(memory_, CL_TRUE, first * sizeof(T), values.size_bytes(), values.data());
    }
    std::vector<T> read(const Device& device, std::size_t first, std::size_t count) const {
        std::vector<T> values(count);
        if (count > 0)
            device.queue.enqueueReadBuffer(memory_, CL_TRUE, first * sizeof(T), count * sizeof(T), values.data());
        return values;
    }
    std::vector<T> read(const Device& device) const { return read(device, 0, size_); }
    T read_one(const Device& device) const { return read(device, 0, 1).front(); }
    void clear(const Device& device) { device.queue.enqueueFillBuffer(memory_, cl_uchar{0}, 0, size_ * sizeof(T)); }

  private:
    std::size_t size_ = 0;
    cl::Buffer memory_;
};

}  // namespace raymill
