#pragma once
// Parses scenes from text.

#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include <knurl/reps/all.hpp>
#include <knurl/scenefile/scene_file.hpp>

#include "../refusal.hpp"

namespace knurl::scenefile {

inline SceneFile scene_of(const std::string& text) {
    return parse_scene(text, "S.toml");
}

template <class R>
R params_of(const Change& change) {
    EXPECT_EQ(change.kind, kind_of<R>);
    EXPECT_EQ(change.params.size(), sizeof(R));
    R params;
    std::memcpy(&params, change.params.data(), sizeof params);
    return params;
}

inline std::string error_of(const std::string& text) {
    return test::refusal_of<SceneError>([&] { scene_of(text); });
}

}  // namespace knurl::scenefile
