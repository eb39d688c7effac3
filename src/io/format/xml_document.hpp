#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "posewise/core/errors.hpp"

namespace posewise::detail {

/// The bytes [begin, end) of `<name ...>` or `<name .../>` in a text.
struct StartTag {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// A whole XML file that knows where each element stands. Nothing is ever expanded or fetched.
class XmlDocument {
  public:
    /// Throws InputError with the place for what is not XML, and for what no file of a person
    /// needs and only an attack has: over 4 MiB, a document type (and so entities of its own),
    /// tags over 64 KiB, elements nested more than 50 deep, NUL bytes.
    explicit XmlDocument(const std::string& path);

    const std::string& path() const { return path_; }
    const std::string& content() const { return content_; }
    pugi::xml_node root() const { return document_.document_element(); }
    /// In the order of the file.

    StartTag start_tag(pugi::xml_node element) const;
    /// Where the element begins.
    FileLocation location(pugi::xml_node element) const;
    /// `path:line:column: problem` of the element.
    InputError error(pugi::xml_node element, const std::string& problem) const;

  private:
    FileLocation location_at(std::size_t position) const;
    void collect_elements(pugi::xml_node parent, int depth);
    void check_top_level() const;
    void check_tags() const;
    InputError parse_error(const pugi::xml_parse_result& result) const;
    InputError mismatch_error(std::size_t end_tag) const;

    std::string path_;
    std::string content_;
    std::vector<std::size_t> line_begins_;
    pugi::xml_document document_;
    std::vector<pugi::xml_node> elements_;
};

}  // namespace posewise::detail
