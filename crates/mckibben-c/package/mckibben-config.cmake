# find_package(mckibben) gives mckibben::mckibben, the shared library, and mckibben::mckibben_static.
get_filename_component(_mckibben_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET mckibben::mckibben)
    add_library(mckibben::mckibben SHARED IMPORTED)
    set_target_properties(mckibben::mckibben PROPERTIES
        IMPORTED_LOCATION "${_mckibben_prefix}/lib/${CMAKE_SHARED_LIBRARY_PREFIX}mckibben_c${CMAKE_SHARED_LIBRARY_SUFFIX}"
        INTERFACE_INCLUDE_DIRECTORIES "${_mckibben_prefix}/include")

    if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
        set_target_properties(mckibben::mckibben PROPERTIES IMPORTED_SONAME "libmckibben_c.so")
    else()
        set_target_properties(mckibben::mckibben PROPERTIES IMPORTED_NO_SONAME TRUE)
    endif()

    if(WIN32)
        set_target_properties(mckibben::mckibben PROPERTIES
            IMPORTED_IMPLIB "${_mckibben_prefix}/lib/mckibben_c.dll.lib")
    endif()

    find_package(Threads REQUIRED)
    add_library(mckibben::mckibben_static STATIC IMPORTED)
    set_target_properties(mckibben::mckibben_static PROPERTIES
        IMPORTED_LOCATION "${_mckibben_prefix}/lib/${CMAKE_STATIC_LIBRARY_PREFIX}mckibben_c${CMAKE_STATIC_LIBRARY_SUFFIX}"
        INTERFACE_INCLUDE_DIRECTORIES "${_mckibben_prefix}/include"
        INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
endif()

unset(_mckibben_prefix)
