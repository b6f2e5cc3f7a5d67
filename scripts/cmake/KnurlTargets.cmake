# What every target of Knurl shares: the language, the warnings, the sanitizers, the include root.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

add_library(knurl_options INTERFACE)
# Without contraction a*b + c rounds the same everywhere, and a x b = -(b x a) holds to the last bit.
target_compile_options(knurl_options INTERFACE -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion)
# Most of the time to compile a source of Knurl goes into the templates of Eigen and GoogleTest, which its neighbours instantiate
# too: three sources of the servo's tests take 18 s one by one and 8 s together. Two sources of a target that give one name to
# different things in an unnamed namespace get namespaces of their own (x_tests for x.cpp). Whether each source compiles by
# itself is what scripts/lint sees.
set(CMAKE_UNITY_BUILD ${KNURL_BATCHES})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 10)
# There a local of one source may have the name that another gives to its constant; and to GCC the sources are headers there, in
# which an unnamed namespace would be suspect.
set(together $<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>)
target_compile_options(knurl_options INTERFACE
    $<$<NOT:${together}>:-Wshadow> $<$<AND:${together},$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>)
if(KNURL_DEVELOPER)
    target_compile_options(knurl_options INTERFACE -Werror)
endif()
if(KNURL_SANITIZE)
    target_compile_options(knurl_options INTERFACE -fsanitize=${KNURL_SANITIZE} -fno-omit-frame-pointer
                                                   -fno-sanitize-recover=all)
    if(KNURL_SANITIZE_NOT)
        target_compile_options(knurl_options INTERFACE -fno-sanitize=${KNURL_SANITIZE_NOT})
    endif()
    target_link_options(knurl_options INTERFACE -fsanitize=${KNURL_SANITIZE})
    # GCC's manual: with -fsanitize it sees uninitialised values where there are none (in std::regex, for one).
    target_compile_options(knurl_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    if(KNURL_SANITIZE MATCHES "thread")
        # GCC warns that ThreadSanitizer does not understand fences; the models in tests/shm guard those.
        target_compile_options(knurl_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
    endif()
endif()

# knurl_module(shm DEPENDS ... [NEEDS package ...]): a library knurl::shm from all .cpp files under src/, whose
# include root is ./include.
# A target sees the headers of another module only by linking it: the compiler guards the walls between the modules.
# NEEDS names the packages (KnurlDependencies.cmake) of what it links, so that who finds an installed Knurl finds them.
function(knurl_module name)
    cmake_parse_arguments(arg "" "" "DEPENDS;PRIVATE;NEEDS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
    if(sources)
        add_library(knurl_${name} STATIC ${sources})
        target_include_directories(knurl_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
        target_link_libraries(knurl_${name} PUBLIC ${arg_DEPENDS}
                              PRIVATE $<BUILD_INTERFACE:knurl_options> ${arg_PRIVATE})
        target_compile_features(knurl_${name} PUBLIC cxx_std_20)
    else()
        add_library(knurl_${name} INTERFACE)
        target_include_directories(knurl_${name} INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
        target_link_libraries(knurl_${name} INTERFACE ${arg_DEPENDS})
        target_compile_features(knurl_${name} INTERFACE cxx_std_20)
    endif()
    set_target_properties(knurl_${name} PROPERTIES EXPORT_NAME ${name})
    add_library(knurl::${name} ALIAS knurl_${name})

    # With what its modules link and need: users before what they use, as a linker wants them.
    set(uses "")
    if(sources)
        set(uses ${name})
    endif()
    foreach(target IN LISTS arg_DEPENDS arg_PRIVATE)
        if(target MATCHES "^knurl::(.*)")
            get_property(of_module GLOBAL PROPERTY KNURL_USES_${CMAKE_MATCH_1})
            get_property(needs GLOBAL PROPERTY KNURL_NEEDS_${CMAKE_MATCH_1})
            list(APPEND uses ${of_module})
            list(APPEND arg_NEEDS ${needs})
        endif()
    endforeach()
    list(REVERSE uses)
    list(REMOVE_DUPLICATES uses)
    list(REVERSE uses)
    list(REMOVE_DUPLICATES arg_NEEDS)
    set_property(GLOBAL PROPERTY KNURL_USES_${name} ${uses})
    set_property(GLOBAL PROPERTY KNURL_NEEDS_${name} ${arg_NEEDS})
    set_property(GLOBAL APPEND PROPERTY KNURL_MODULES ${name})

    if(KNURL_INSTALL)
        install(TARGETS knurl_${name} EXPORT knurlTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
        install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    endif()
endfunction()

# knurl_tool_library(measure DEPENDS ... PRIVATE ...): a library from src/*.cpp whose include root is ./include, for programs and
# tests alone: it is not installed.
function(knurl_tool_library name)
    cmake_parse_arguments(arg "" "" "DEPENDS;PRIVATE" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
    add_library(knurl_${name} STATIC ${sources})
    target_include_directories(knurl_${name} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/include)
    target_link_libraries(knurl_${name} PUBLIC ${arg_DEPENDS} PRIVATE knurl_options ${arg_PRIVATE})
    target_compile_features(knurl_${name} PUBLIC cxx_std_20)
endfunction()

if(KNURL_BUILD_TESTS)
    add_custom_target(knurl_guarded)
endif()

set(knurl_test_optimization $<$<CONFIG:Release,RelWithDebInfo>:-O1>)

# knurl_test(name SOURCES a.cpp ... LINK targets ... [TIMEOUT s] [PREFIX p.] [OPTIMIZED] [SERIAL] [PROCESS] [GUARDED]): a GoogleTest
# program, its cases in ctest. Most of what a test compiles is headers and its own prose: the headers that all of them read are read once
# (knurl_test_headers, in tests/), and the test's own code is built with -O1, in half the time; what it tests is a library
# and keeps its -O3. OPTIMIZED is for tests whose subject is a template, so that they see the code that users run. SERIAL
# ones run beside no other. PROCESS ones start programs: CI runs them once more without any right (scripts/test --restricted).
# GUARDED ones, which start none, are built (target knurl_guarded) and run by CI once more, under ASan and UBSan.
function(knurl_test name)
    cmake_parse_arguments(arg "OPTIMIZED;SERIAL;PROCESS;GUARDED" "TIMEOUT;PREFIX" "SOURCES;LINK" ${ARGN})
    if(NOT arg_TIMEOUT)
        set(arg_TIMEOUT 120)
    endif()
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE knurl_options ${arg_LINK} GTest::gtest_main)
    if(NOT arg_OPTIMIZED)
        target_compile_options(${name} PRIVATE ${knurl_test_optimization})
        if(TARGET knurl_test_headers)
            target_precompile_headers(${name} REUSE_FROM knurl_test_headers)
        endif()
    endif()
    set(labels "")
    if(arg_PROCESS)
        set(labels LABELS process)
    elseif(arg_GUARDED)
        set(labels LABELS guarded)
        add_dependencies(knurl_guarded ${name})
    endif()
    gtest_discover_tests(${name} TEST_PREFIX "${arg_PREFIX}" PROPERTIES TIMEOUT ${arg_TIMEOUT} RUN_SERIAL ${arg_SERIAL} ${labels}
                         DISCOVERY_TIMEOUT 60)
endfunction()

# knurl_benchmark(name SOURCES ... LINK ...): a Google Benchmark program; run by scripts/bench, never by ctest.
function(knurl_benchmark name)
    cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE knurl_options ${arg_LINK} benchmark::benchmark)
    knurl_only_measures(${name})
endfunction()

# knurl_only_measures(target...): no test runs it, so it is built when somebody asks for it or for all of them (target
# knurl_benchmarks).
function(knurl_only_measures)
    if(NOT TARGET knurl_benchmarks)
        add_custom_target(knurl_benchmarks)
    endif()
    set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(knurl_benchmarks ${ARGN})
endfunction()
