# Fuzz targets: X.cpp defines LLVMFuzzerTestOneInput. Each is built twice.
#   knurl_replay_X  as everything else is built, with the sanitizers that it has: ctest's fuzz.X feeds it the kept inputs and, by
#                   a seed, alterations of them (tests/fuzz/replay.cpp)
#   knurl_fuzz_X    libFuzzer with ASan and UBSan, by Clang whatever the rest is built with; a part of the target knurl_fuzzers.
#                   fuzz.X.long, of scripts/test --long, runs it for a minute, and leaves what breaks it beside it as crash-*.
#                   For longer: scripts/fuzz --seconds 3600 --target X
# The kept inputs of a target are one text file (scripts/corpus), which the build unpacks.
find_program(KNURL_CLANG clang++-14)
if(NOT TARGET knurl_fuzzers)
    add_custom_target(knurl_fuzzers)
    file(REMOVE_RECURSE ${PROJECT_BINARY_DIR}/fuzzers)
    if(KNURL_BUILD_TESTS)
        add_library(knurl_replay OBJECT ${PROJECT_SOURCE_DIR}/tests/fuzz/replay.cpp)
        target_link_libraries(knurl_replay PRIVATE knurl_options)
        target_compile_options(knurl_replay PRIVATE ${knurl_test_optimization})
    endif()
endif()

# -O2: with -O1 the templates of Eigen are calls, and what computes takes twice as long.
set(fuzz_flags -std=c++20 -O2 -gline-tables-only -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -Wall -Wextra)

# One object per source, shared by the targets of a folder: each compiles once. Uses the folder's fuzz_flags and fuzz_includes.
function(knurl_fuzz_object source out)
    get_filename_component(name ${source} NAME_WE)
    set(object ${CMAKE_CURRENT_BINARY_DIR}/${name}.fuzz.o)
    add_custom_command(OUTPUT ${object}
        COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${KNURL_CLANG} ${fuzz_flags} ${fuzz_includes} -MD -MF ${object}.d -c ${source} -o ${object}
        DEPENDS ${source} DEPFILE ${object}.d COMMENT "Fuzzing object ${name}")
    set(${out} ${object} PARENT_SCOPE)
endfunction()

# knurl_fuzz_library(name SOURCES... [SINGLE sources...]): the objects of what is fuzzed together, compiled in batches as everywhere.
# SINGLE ones get objects of their own: a target that defines what is in one takes its own.
function(knurl_fuzz_library name)
    cmake_parse_arguments(arg "" "" "SINGLE" ${ARGN})
    set(batch 1)
    if(KNURL_BATCHES)
        set(batch ${CMAKE_UNITY_BUILD_BATCH_SIZE})
    endif()
    set(objects "")
    set(text "")
    set(count 0)
    list(LENGTH arg_UNPARSED_ARGUMENTS all)
    foreach(source ${arg_UNPARSED_ARGUMENTS})
        string(APPEND text "#include \"${source}\"\n")
        math(EXPR count "${count} + 1")
        math(EXPR over "${count} % ${batch}")
        if(over EQUAL 0 OR count EQUAL all)
            set(batched ${CMAKE_CURRENT_BINARY_DIR}/${name}_${count}.cpp)
            file(CONFIGURE OUTPUT ${batched} CONTENT "${text}")
            knurl_fuzz_object(${batched} object)
            list(APPEND objects ${object})
            set(text "")
        endif()
    endforeach()
    foreach(source ${arg_SINGLE})
        knurl_fuzz_object(${source} object)
        list(APPEND objects ${object})
    endforeach()
    set(library ${CMAKE_CURRENT_BINARY_DIR}/lib${name}.a)
    add_custom_command(OUTPUT ${library} COMMAND ${CMAKE_COMMAND} -E rm -f ${library} COMMAND ${CMAKE_AR} rcs ${library} ${objects}
        DEPENDS ${objects} COMMENT "Fuzzing objects of ${name} together")
    # Made once, whichever targets are built beside each other.
    add_custom_target(${name} DEPENDS ${library})
endfunction()

# knurl_fuzz(name libraries max_len REPLAY targets... [DICTIONARY file] [LINK flags] [ALTERATIONS n]): fuzz target name.cpp, with
# the kept inputs of name.corpus, if there are any. REPLAY has what is fuzzed as ordinary targets; `libraries` the same for libFuzzer, which is linked with LINK.
function(knurl_fuzz name library max_len)
    cmake_parse_arguments(arg "" "DICTIONARY;ALTERATIONS" "REPLAY;LINK" ${ARGN})
    if(NOT arg_ALTERATIONS)
        set(arg_ALTERATIONS 5000)
    endif()
    add_executable(knurl_replay_${name} ${name}.cpp)
    target_link_libraries(knurl_replay_${name} PRIVATE knurl_options knurl_replay ${arg_REPLAY})
    target_compile_options(knurl_replay_${name} PRIVATE ${knurl_test_optimization})
    set(corpus "")
    set(unpacked "")
    set(packed ${CMAKE_CURRENT_SOURCE_DIR}/${name}.corpus)
    if(EXISTS ${packed})
        set(corpus ${CMAKE_CURRENT_BINARY_DIR}/corpus_${name})
        add_custom_command(OUTPUT ${corpus}.unpacked
            COMMAND ${PROJECT_SOURCE_DIR}/scripts/corpus unpack ${packed} ${corpus}
            COMMAND ${CMAKE_COMMAND} -E touch ${corpus}.unpacked
            DEPENDS ${packed} ${PROJECT_SOURCE_DIR}/scripts/corpus COMMENT "Kept inputs of ${name}")
        set(unpacked ${corpus}.unpacked)
        target_sources(knurl_replay_${name} PRIVATE ${unpacked})
    endif()
    add_test(NAME fuzz.${name} COMMAND knurl_replay_${name} ${max_len} ${arg_ALTERATIONS} last_of_${name} ${corpus})
    set_tests_properties(fuzz.${name} PROPERTIES TIMEOUT 60 WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} LABELS guarded)
    add_dependencies(knurl_guarded knurl_replay_${name})
    if(KNURL_SANITIZE OR NOT KNURL_CLANG)
        return()
    endif()

    knurl_fuzz_object(${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp object)
    set(program ${CMAKE_CURRENT_BINARY_DIR}/knurl_fuzz_${name})
    set(archives ${library})
    list(TRANSFORM archives REPLACE "(.+)" "${CMAKE_CURRENT_BINARY_DIR}/lib\\1.a")
    add_custom_command(OUTPUT ${program}
        COMMAND ${KNURL_CLANG} -fsanitize=fuzzer,address,undefined ${object} -Wl,--start-group ${archives} -Wl,--end-group
                ${arg_LINK} -o ${program}
        DEPENDS ${object} ${archives} COMMENT "Fuzz target ${name}")
    add_custom_target(fuzz_${name} DEPENDS ${program} ${unpacked})
    add_dependencies(fuzz_${name} ${library})
    add_dependencies(knurl_fuzzers fuzz_${name})
    set(found ${CMAKE_CURRENT_BINARY_DIR}/found_${name})
    file(MAKE_DIRECTORY ${found})
    set(run ${program} -max_len=${max_len} -timeout=5 -rss_limit_mb=1000 -print_final_stats=1)
    if(arg_DICTIONARY)
        list(APPEND run -dict=${arg_DICTIONARY})
    endif()
    # For scripts/fuzz: the program and its arguments, a word a line.
    set(words ${run} ${found} ${corpus})
    list(JOIN words "\n" words)
    file(WRITE ${PROJECT_BINARY_DIR}/fuzzers/${name} "${words}\n")
    add_test(NAME fuzz.${name}.long COMMAND ${run} -max_total_time=60 ${found} ${corpus})
    set_tests_properties(fuzz.${name}.long PROPERTIES TIMEOUT 180 WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} LABELS long)
endfunction()
