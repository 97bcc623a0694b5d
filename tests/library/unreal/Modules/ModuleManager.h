#pragma once

struct FDefaultModuleImpl {};
#define IMPLEMENT_MODULE(kind, name) [[maybe_unused]] static kind name;
