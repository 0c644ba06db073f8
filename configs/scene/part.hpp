#pragma once
// A part of the scene that lies in memory of its own, so that scene.hpp needs no definition of its type.

#include <memory>

namespace wade {

// Owns a T and copies it with itself. `part->member` needs the header of T; passing the part on as T& does not. Special members
// are instantiated in scene.cpp, like the scene's own. A part that was moved from may only be destroyed or assigned a
// part.
template <typename T>
class Part {
 public:
    Part() : value_(std::make_unique<T>()) {}
    Part(const Part& other) : value_(std::make_unique<T>(*other)) {}
    Part(Part&& other) noexcept = default;
    Part& operator=(const Part& other) {
        if (this != &other) value_ = std::make_unique<T>(*other);
        return *this;
    }
    Part& operator=(Part&& other) noexcept = default;
    Part& operator=(const T& value) {
        *value_ = value;
        return *this;
    }
    ~Part() = default;

    [[nodiscard]] T* operator->() { return value_.get(); }
    [[nodiscard]] const T* operator->() const { return value_.get(); }
    [[nodiscard]] T& operator*() { return *value_; }
    [[nodiscard]] const T& operator*() const { return *value_; }
    operator T&() { return *value_; }
    operator const T&() const { return *value_; }

 private:
    std::unique_ptr<T> value_;
};

}  // namespace wade
