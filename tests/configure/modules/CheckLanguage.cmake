# In place of CMake's own module: a compiler is there if `compiler_is_there` says so. As there, what
# was found once is not looked for again, nor is what was not found.
macro(check_language language)
  if(NOT DEFINED CMAKE_${language}_COMPILER)
    if(compiler_is_there)
      set(CMAKE_${language}_COMPILER "/a/compiler" CACHE FILEPATH "")
    else()
      set(CMAKE_${language}_COMPILER NOTFOUND CACHE FILEPATH "")
    endif()
  endif()
endmacro()
