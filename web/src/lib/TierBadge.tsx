import { Badge } from "@mantine/core";
import type { Device } from "../api/queries";
import { TIERS } from "./tiers";

/** How deep a device's model is known, where that is not all the way. */
export function TierBadge({ device }: { device: Device }) {
  const tier = TIERS[device.about.tier];
  return (
    tier && (
      <Badge size="xs" variant="default" title={tier.help}>
        {tier.word}
      </Badge>
    )
  );
}
