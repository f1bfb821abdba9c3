# Writes OUTPUT: every kernel file under ROOT named in FILES as a raw string literal.
set(text "// Made by embed_kernels.cmake from kernels/.\n#include \"device/kernel_source.hpp\"\n\nnamespace raymill {\n\n")
string(APPEND text "const std::vector<KernelFile>& embedded_kernels() {\n    static const std::vector<KernelFile> files = {\n")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} content)
  string(APPEND text "        {\"${file}\", R\"kernel(${content})kernel\"},\n")
endforeach()
string(APPEND text "    };\n    return files;\n}\n\n}  // namespace raymill\n")
file(WRITE ${OUTPUT} "${text}")
