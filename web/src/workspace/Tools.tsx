import { ActionIcon, Button, FileButton, Menu } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { IconCheck, IconLayoutDashboard } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useRef, useState } from "react";
import { createPortal } from "react-dom";
import { ApiError, problemOf } from "../api/problem";
import { putIntoAddress, useAddress } from "../lib/address";
import { useShared } from "../lib/shared";
import { usePhone } from "../lib/usePhone";
import { copyLink } from "../shell/CopyLink";
import { AddMenu } from "./AddMenu";
import { ArrangeList } from "./ArrangeList";
import { BUILT_IN } from "./builtIn";
import { isNewer } from "./document";
import { ARRANGING, type Layout, useLayouts } from "./layouts";
import { NameDialog } from "./NameDialog";
import { exportFile, importFile, remove, reset, revert, save, saveAs, show } from "./saving";

const TOAST = "layout";

type Asked = "saveAs" | "rename" | null;

/** Everything that can be done to a layout: in the header, and on a phone below the panels. */
export function Tools({ layout }: { layout: Layout }) {
  const phone = usePhone();
  const header = document.getElementById("page-tools");
  if (phone)
    return (
      <ArrangeList layout={layout}>
        <AddMenu layout={layout} />
        <LayoutMenu layout={layout} />
      </ArrangeList>
    );
  return header && createPortal(<HeaderTools layout={layout} />, header);
}

function HeaderTools({ layout }: { layout: Layout }) {
  const arranging = useShared(ARRANGING);
  const { max } = useAddress("max");
  return (
    <>
      {max !== "" && (
        <Button size="compact-sm" variant="default" onClick={() => putIntoAddress({ max: "" }, "step")}>
          All panels
        </Button>
      )}
      {arranging && max === "" && (
        <>
          <AddMenu layout={layout} />
          <Button
            size="compact-sm"
            leftSection={<IconCheck size={14} aria-hidden />}
            onClick={() => ARRANGING.set(false)}
          >
            Done
          </Button>
        </>
      )}
      <LayoutMenu layout={layout} />
    </>
  );
}

function LayoutMenu({ layout }: { layout: Layout }) {
  const { document, id, saved, touched, put } = layout;
  const queries = useQueryClient();
  const phone = usePhone();
  const list = useLayouts();
  const arranging = useShared(ARRANGING);
  const [asked, ask] = useState<Asked>(null);
  const open = useRef<() => void>(null);
  const kept = list.data?.layouts ?? [];
  const names = [
    ...BUILT_IN.map(({ id: each, name }) => [each, kept.find((one) => one.id === each)?.name ?? name] as const),
    ...kept
      .filter(({ id: each }) => !BUILT_IN.some((one) => one.id === each))
      .map((one) => [one.id, one.name] as const),
  ];
  const builtIn = BUILT_IN.some((each) => each.id === id);
  const newer = isNewer(document);

  async function run(doing: string, work: () => Promise<void>) {
    notifications.hide(TOAST);
    try {
      await work();
    } catch (error) {
      tell(doing, error);
    }
  }
  function tell(doing: string, error: unknown) {
    const { detail, way_out, type, facts } = problemOf(error);
    const conflict = error instanceof ApiError && type === "/problems/layout-changed";
    notifications.show({
      id: TOAST,
      color: "red",
      title: conflict ? "This layout was saved elsewhere meanwhile" : `${doing} failed`,
      message: conflict ? (
        <>
          Yours is not saved, and nothing is lost. Save it under another name, look at theirs by Revert, or{" "}
          <Button
            size="compact-xs"
            variant="default"
            onClick={() => void run("Saving", () => save(queries, document, Number(facts.revision)))}
          >
            Save over theirs
          </Button>
        </>
      ) : (
        [detail, way_out].filter(Boolean).join(" ")
      ),
      autoClose: false,
    });
    void list.refetch();
  }
  const label = `Layout: ${document.name}${touched ? ", not saved" : ""}`;
  return (
    <>
      <Menu position="bottom-end" withinPortal>
        <Menu.Target>
          {phone ? (
            <Button size="sm" variant="default" leftSection={<IconLayoutDashboard size={16} aria-hidden />}>
              {label}
            </Button>
          ) : (
            <ActionIcon aria-label={label} title={label} data-touched={touched} data-testid="layout-menu">
              <IconLayoutDashboard size={18} />
            </ActionIcon>
          )}
        </Menu.Target>
        <Menu.Dropdown mah="80dvh" style={{ overflowY: "auto" }}>
          {!phone && (
            <Menu.Item onClick={() => ARRANGING.set(!arranging)} disabled={newer}>
              {arranging ? "Done arranging" : "Arrange the panels"}
            </Menu.Item>
          )}
          <Menu.Label>Layouts</Menu.Label>
          {names.map(([each, name]) => (
            <Menu.Item
              key={each}
              aria-current={each === id || undefined}
              leftSection={each === id ? <IconCheck size={14} aria-hidden /> : <span style={{ width: 14 }} />}
              onClick={() => show(each)}
            >
              {name}
            </Menu.Item>
          ))}
          <Menu.Divider />
          <Menu.Item disabled={!touched || newer} onClick={() => void run("Saving", () => save(queries, document))}>
            Save
          </Menu.Item>
          <Menu.Item onClick={() => ask("saveAs")}>Save as…</Menu.Item>
          <Menu.Item disabled={newer} onClick={() => ask("rename")}>
            Rename…
          </Menu.Item>
          <Menu.Item disabled={!touched} onClick={() => revert(document)}>
            Revert to what is saved
          </Menu.Item>
          {builtIn && <Menu.Item onClick={() => reset(document)}>Reset to how it came</Menu.Item>}
          <Menu.Divider />
          <Menu.Item onClick={() => void copyLink()}>Copy the link</Menu.Item>
          <Menu.Item onClick={() => exportFile(document)}>Export as a file</Menu.Item>
          <Menu.Item onClick={() => open.current?.()}>Import a file…</Menu.Item>
          {saved && (
            <Menu.Item color="red" onClick={() => void run("Deleting", () => remove(queries, document))}>
              Delete what is saved
            </Menu.Item>
          )}
        </Menu.Dropdown>
      </Menu>
      <FileButton
        accept="application/json,.json"
        onChange={(file) => file && void run("Importing", () => importFile(queries, file))}
      >
        {({ onClick }) => {
          open.current = onClick;
          return null;
        }}
      </FileButton>
      <NameDialog
        opened={asked !== null}
        title={asked === "rename" ? "Rename the layout" : "Save the layout under a name"}
        name={document.name}
        close={() => ask(null)}
        done={(name) =>
          asked === "rename"
            ? put({ ...document, name }, `The layout is called ${name}`)
            : void run("Saving", () => saveAs(queries, document, name))
        }
      />
    </>
  );
}
