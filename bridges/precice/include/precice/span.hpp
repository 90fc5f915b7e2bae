#ifndef PRECICE_SPAN_HPP
#define PRECICE_SPAN_HPP

#include <cstddef>
#include <cstring>
#include <iterator>
#include <type_traits>
#include <utility>

namespace precice {

namespace detail {

/// Pointer to the first value of a container or an array.
template <typename Container>
using Pointer = decltype(std::data(std::declval<Container &>()));

} // namespace detail

/// Values stored one after the other in memory that the span does not own.
template <typename T>
class span {
public:
  using element_type = T;
  using value_type = std::remove_cv_t<T>;
  using size_type = std::size_t;
  using difference_type = std::ptrdiff_t;
  using pointer = T *;
  using reference = T &;
  using iterator = T *;

  constexpr span() noexcept = default;

  constexpr span(pointer first, size_type count) noexcept : _data(first), _size(count) {}

  /// Covers a container, an array or another span. An array of characters is a string, see below.
  template <typename Container, typename = std::enable_if_t<
      std::is_convertible_v<std::remove_pointer_t<detail::Pointer<Container>> (*)[], T (*)[]> &&
      !(std::is_array_v<std::remove_reference_t<Container>> && std::is_same_v<value_type, char>)>>
  constexpr span(Container &&container)
      : _data(std::data(container)), _size(std::size(container)) {}

  /// Covers a null-terminated string without its end.
  template <typename Char, typename = std::enable_if_t<
      std::is_same_v<T, const char> && std::is_same_v<std::remove_cv_t<Char>, char>>>
  span(Char *text) : _data(text), _size(std::strlen(text)) {}

  constexpr pointer data() const noexcept { return _data; }
  constexpr size_type size() const noexcept { return _size; }
  constexpr size_type size_bytes() const noexcept { return _size * sizeof(T); }
  [[nodiscard]] constexpr bool empty() const noexcept { return _size == 0; }

  constexpr reference operator[](size_type index) const { return _data[index]; }
  constexpr reference front() const { return _data[0]; }
  constexpr reference back() const { return _data[_size - 1]; }
  constexpr iterator begin() const noexcept { return _data; }
  constexpr iterator end() const noexcept { return _data + _size; }

  constexpr span first(size_type count) const { return {_data, count}; }
  constexpr span last(size_type count) const { return {_data + (_size - count), count}; }
  constexpr span subspan(size_type offset) const { return {_data + offset, _size - offset}; }
  constexpr span subspan(size_type offset, size_type count) const {
    return {_data + offset, count};
  }

private:
  pointer _data = nullptr;
  size_type _size = 0;
};

template <typename Container>
span(Container &&) -> span<std::remove_pointer_t<detail::Pointer<Container>>>;

/// Text that need not end with a null character.
using string_view = span<const char>;

} // namespace precice

#endif
