#pragma once

#include <string>

#include "places.hpp"
#include "posewise/io/campaign_file.hpp"
#include "temporary_folder.hpp"

namespace posewise::testing {

/// A campaign file of this text, read.
inline io::CampaignFile campaign_from(const std::string& text) {
    const TemporaryFolder folder;
    return io::read_campaign(folder.write("campaign.yaml", text));
}

/// A campaign that is shipped: "cell_demo/campaign.yaml".
inline io::CampaignFile design_campaign(const std::string& name) {
    return io::read_campaign(source_folder() + "/designs/" + name);
}

}  // namespace posewise::testing
