// Stands for the parts of Unreal that clients/unreal uses, as far as the compiler and unreal_test.cpp need them.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

using int32 = std::int32_t;
struct FVector {
  double X, Y, Z;
};
struct FString {
  std::string Text;
  const char* operator*() const { return Text.c_str(); }
};
using FCriticalSection = std::mutex;
struct FScopeLock {
  explicit FScopeLock(FCriticalSection* mutex) : lock(*mutex) {}
  std::scoped_lock<std::mutex> lock;
};
template <class T>
struct TArray {
  std::vector<T> items;
  void Init(const T& item, int32 size) { items.assign(static_cast<std::size_t>(size), item); }
  T* GetData() { return items.data(); }
  T& operator[](int32 i) { return items[static_cast<std::size_t>(i)]; }
};

inline std::string& unreal_log() {
  static std::string log;
  return log;
}
#define TEXT(text) text
#define UTF8_TO_TCHAR(text) text
#define TCHAR_TO_UTF8(text) text
#define UE_LOG(category, level, pattern, text) unreal_log() += text
#define DEFINE_LOG_CATEGORY_STATIC(...) static_assert(true)
#define UCLASS(...)
#define UFUNCTION(...)
#define GENERATED_BODY() using Super = USynthComponent;
#define RINGDOWNSYNTH_API
