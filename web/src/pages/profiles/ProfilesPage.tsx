import { Text } from "@mantine/core";
import { IconFileDescription } from "@tabler/icons-react";
import { putIntoAddress, useAddress } from "../../lib/address";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { Page } from "../../lib/Page";
import { ProfileView } from "./ProfileView";
import { SavedProfiles } from "./SavedProfiles";

/** Whole configurations: kept, compared, applied, handed on. */
export default function ProfilesPage() {
  const given = Number(useAddress("profile").profile);
  const selected = Number.isInteger(given) && given > 0 ? given : null;
  const select = (id: number | null) => putIntoAddress({ profile: id === null ? "" : String(id) }, "step");
  return (
    <Page name="Profiles">
      <div className="columns side-left until-62">
        <SavedProfiles selected={selected} onSelect={select} />
        {selected === null ? (
          <Card title="Profile">
            <EmptyState title="Choose a profile" icon={<IconFileDescription size={22} />}>
              <Text size="sm" className="dim" maw={430}>
                It is then compared with the device, can be applied to it as a whole, and becomes a script that was
                tried on an emulator.
              </Text>
            </EmptyState>
          </Card>
        ) : (
          <ProfileView key={selected} id={selected} onGone={() => select(null)} />
        )}
      </div>
    </Page>
  );
}
