import { ActionIcon } from "@mantine/core";
import { IconLayoutDashboard } from "@tabler/icons-react";
import { useState } from "react";
import { createPortal } from "react-dom";
import { useAddress } from "../lib/address";
import { later } from "../lib/later";
import { useShared } from "../lib/shared";
import { usePhone } from "../lib/usePhone";
import { ARRANGING, type Layout, labelOf } from "./layout";

const ArrangeList = later(() => import("./ArrangeList").then((part) => part.ArrangeList));
const ArrangeTools = later(() => import("./ArrangeTools").then((part) => part.ArrangeTools));
const LayoutMenu = later(() => import("./LayoutMenu").then((part) => part.LayoutMenu));

/** Everything that can be done to a layout: in the header, and on a phone below the panels. */
export function Tools({ layout }: { layout: Layout }) {
  const phone = usePhone();
  const arranging = useShared(ARRANGING);
  const { max } = useAddress("max");
  if (phone) return <ArrangeList layout={layout} />;
  const header = document.getElementById("page-tools");
  const tools = (
    <>
      {(arranging || max !== "") && <ArrangeTools layout={layout} />}
      <LayoutButton layout={layout} />
    </>
  );
  return header && createPortal(tools, header);
}

function LayoutButton({ layout }: { layout: Layout }) {
  const [opened, setOpened] = useState(false);
  const [wanted, setWanted] = useState(false);
  const label = labelOf(layout);
  return (
    <span>
      <ActionIcon
        aria-label={label}
        title={label}
        aria-haspopup="menu"
        onClick={() => {
          setWanted(true);
          setOpened(true);
        }}
        data-touched={layout.touched}
        data-testid="layout-menu"
      >
        <IconLayoutDashboard size={18} />
      </ActionIcon>
      {wanted && <LayoutMenu layout={layout} opened={opened} onChange={setOpened} />}
    </span>
  );
}
