# Writes OUTPUT: report.html under ROOT with its style and scripts in it, cut where the data goes, as two raw string
# literals. FILES: report.html, report.css, then the scripts in the order in which they run.
list(POP_FRONT FILES page_file style_file)
file(READ ${ROOT}/${page_file} page)
file(READ ${ROOT}/${style_file} style)
set(script "")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} content)
  string(APPEND script "${content}")
endforeach()
foreach(part style script data)
  string(FIND "${page}" "{{${part}}}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${page_file} has no place for {{${part}}}")
  endif()
endforeach()
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")
string(FIND "${page}" "{{data}}" place)
string(SUBSTRING "${page}" 0 ${place} before)
string(LENGTH "{{data}}" length)
math(EXPR rest "${place} + ${length}")
string(SUBSTRING "${page}" ${rest} -1 after)
file(WRITE ${OUTPUT} "// Made by embed_report.cmake from report/.
#include \"profile/report_page.hpp\"

namespace raymill::profile {

const ReportPage& report_page() {
    static const ReportPage page = {R\"report(${before})report\", R\"report(${after})report\"};
    return page;
}

}  // namespace raymill::profile
")
