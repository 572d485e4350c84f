import { Button } from "@mantine/core";
import { IconCheck } from "@tabler/icons-react";
import { putIntoAddress, useAddress } from "../lib/address";
import { AddMenu } from "./AddMenu";
import { ARRANGING, type Layout } from "./layout";

/** In the header while panels are arranged, or one is as large as it can be: what there is to do, and the way back. */
export function ArrangeTools({ layout }: { layout: Layout }) {
  const { max } = useAddress("max");
  if (max !== "")
    return (
      <Button size="compact-sm" variant="default" onClick={() => putIntoAddress({ max: "" }, "step")}>
        All panels
      </Button>
    );
  return (
    <>
      <AddMenu layout={layout} />
      <Button size="compact-sm" leftSection={<IconCheck size={14} aria-hidden />} onClick={() => ARRANGING.set(false)}>
        Done
      </Button>
    </>
  );
}
