import { Button, FileButton, Menu } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { IconCheck } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { type ReactElement, useRef, useState } from "react";
import { ApiError, problemOf } from "../api/problem";
import { useShared } from "../lib/shared";
import { usePhone } from "../lib/usePhone";
import { copyLink } from "../shell/CopyLink";
import { allLayouts, BUILT_IN } from "./builtIn";
import { isNewer } from "./document";
import { ARRANGING, type Layout } from "./layout";
import { useLayouts } from "./layouts";
import { measure } from "./measured";
import { NameDialog } from "./NameDialog";
import { exportFile, importFile, remove, reset, revert, save, saveAs, show } from "./saving";
import { withScope } from "./scopeKept";

const TOAST = "layout";

type Asked = "saveAs" | "rename" | null;

interface Props {
  layout: Layout;
  opened: boolean;
  onChange: (opened: boolean) => void;
  /** the button that it belongs to, where that is its own */
  children?: ReactElement;
}

/** Which layout is shown, and what can be done to it as a whole. */
export function LayoutMenu({ layout, opened, onChange, children }: Props) {
  const { document, id, saved, touched, put } = layout;
  const queries = useQueryClient();
  const phone = usePhone();
  const list = useLayouts();
  const arranging = useShared(ARRANGING);
  const [asked, ask] = useState<Asked>(null);
  const open = useRef<() => void>(null);
  const kept = list.data?.layouts ?? [];
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
  return (
    <>
      {(opened || children) && (
        <Menu opened={opened} onChange={onChange} position="bottom-end" withinPortal>
          <Menu.Target>{children ?? <span />}</Menu.Target>
          <Menu.Dropdown mah="80dvh" style={{ overflowY: "auto" }}>
            {!phone && (
              <Menu.Item
                onClick={() => {
                  measure();
                  ARRANGING.set(!arranging);
                }}
                disabled={newer}
              >
                {arranging ? "Done arranging" : "Arrange the panels"}
              </Menu.Item>
            )}
            <Menu.Label>Layouts</Menu.Label>
            {allLayouts(kept).map(({ id: each, name }) => (
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
            <Menu.Item disabled={newer} onClick={() => void run("Saving", () => save(queries, document))}>
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
      )}
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
            : void run("Saving", () => saveAs(queries, withScope(document), name))
        }
      />
    </>
  );
}
