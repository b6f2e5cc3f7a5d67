# run(WHAT COMMAND...): sets `output` to what the command printed; ends the script if the command fails.
function(run what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE errors)
    if(NOT result EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "${what} failed (${result}): ${command}\n${output}\n${errors}")
    endif()
    set(output "${output}${errors}" PARENT_SCOPE)
endfunction()
