# knurl_install_help(COMPONENT TARGET...): man pages (where help2man is installed) and completions for bash and zsh of these
# programs, made at installation from what their --help says: scripts/help_pages.py.
find_program(KNURL_HELP2MAN help2man)
function(knurl_install_help component)
    set(made ${CMAKE_CURRENT_BINARY_DIR}/help-${component})
    set(programs "")
    foreach(target IN LISTS ARGN)
        string(APPEND programs " \"$<TARGET_FILE:${target}>\"")
    endforeach()
    set(make "execute_process(COMMAND /usr/bin/python3 \"${PROJECT_SOURCE_DIR}/scripts/help_pages.py\"")
    set(rest "${programs} COMMAND_ERROR_IS_FATAL ANY)")
    set(share "\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}")
    string(CONCAT code "file(REMOVE_RECURSE \"${made}\")\n"
                       "${make} completions \"${made}\"${rest}\n"
                       "file(INSTALL DESTINATION \"${share}/bash-completion/completions\" TYPE DIRECTORY FILES \"${made}/bash/\")\n"
                       "file(INSTALL DESTINATION \"${share}/zsh/vendor-completions\" TYPE DIRECTORY FILES \"${made}/zsh/\")\n")
    if(KNURL_HELP2MAN)
        string(APPEND code "${make} man \"${made}/man\"${rest}\n"
                           "file(INSTALL DESTINATION \"${share}/man/man1\" TYPE DIRECTORY FILES \"${made}/man/\")\n")
    else()
        string(APPEND code "message(STATUS \"no man pages: help2man is not installed\")\n")
    endif()
    install(CODE "${code}" COMPONENT ${component})
endfunction()
