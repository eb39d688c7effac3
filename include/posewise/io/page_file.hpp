#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/measurement/measurements.hpp"
#include "posewise/task/error_map.hpp"
#include "posewise/task/residuals.hpp"
#include "posewise/task/scene.hpp"

/// Results as one HTML file that needs nothing else to be looked at; designs/page.md explains what
/// is in it.
namespace posewise::io {

/// Configurations to draw, as they were measured.
struct PageConfigurations {
    std::vector<std::string> ids;
    RowMatrixXd joints;  ///< ids x joints (and measured torques), rad or m
};

/// What a calibration leaves of the measurements it was made with.
struct PageResiduals {
    std::vector<std::string> axes;   ///< residual_axes()
    std::vector<bool> is_angle;      ///< of each
    std::vector<std::string> names;  ///< reading_names()
    Measurements measurements;
    std::vector<ReadingResidual> readings;
};
/// The same, with the words of the campaign's sensor.
PageResiduals page_residuals(const Campaign& campaign, const Measurements& measurements,
                             std::vector<ReadingResidual> readings);

/// One plan, estimate or study.
struct PagePart {
    std::string title;
    std::optional<std::string> command{};  ///< that made it
    std::string made_at;                   ///< UTC, ISO 8601
    std::optional<std::string> printed{};  ///< by that command as text
    std::string document;                  ///< as to_json() gives it
    std::optional<Scene> scene{};
    std::optional<VectorXd> first_pose{};  ///< of a plan: where its scene is checked
    PageConfigurations configurations{};   ///< measured ones
    std::optional<PageResiduals> residuals{};
    std::optional<ErrorMap> error_map{};
};

/// The document of a page. Throws InputError if a document of a part is none, or if a name in it is
/// not UTF-8.
std::string to_json(const std::vector<PagePart>& parts);

/// The page, parts side by side. Throws InputError as to_json().
std::string to_page(const std::vector<PagePart>& parts);

/// Writes it, all or nothing, with what was warned of while it was made. Throws InputError as
/// to_page(), and if it cannot be written.
void write_page(const std::string& path, const std::vector<PagePart>& parts,
                const std::vector<std::string>& warnings = {});

}  // namespace posewise::io
