import { IconTargetArrow } from "@tabler/icons-react";
import { can, type Device } from "../../api/queries";
import { putIntoAddress, useAddress } from "../../lib/address";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { useSelectedAxis } from "../../live/selection";
import { isMove } from "./byHand/moves";
import { Ranking } from "./byHand/Ranking";
import { StudyList } from "./StudyList";
import { StudyView } from "./StudyView";
import { useChanges, useStudies } from "./useStudies";
import { WishCard } from "./WishCard";

const NOTHING = { icon: <IconTargetArrow size={22} />, wanted: "a chip that moves a motor" };

/** Studies of an axis: what is wanted, what that does to the machine, how it goes, and what came of it. */
export default function TunePage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Tune" />;
  if (!device || !entry || !can(device, "motion")) return <NoDevice page="Tune" {...NOTHING} />;
  return <Tune key={key} device={device} axis={entry} />;
}

function Tune({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const studies = useStudies();
  const { study: picked, kind } = useAddress("study", "kind");
  const changes = useChanges(pick);
  const own = studies.data?.studies.filter((study) => study.device === device.id && study.axis === axis.index) ?? [];
  const runs = own.some(({ state }) => state === "running");
  const shown = own.find(({ id }) => id === picked) ?? own[0];
  const ranking = <Ranking moves={own.filter(isMove)} changes={changes} busy={runs} />;
  // While somebody tunes by hand it is what is looked at; else what a study found, however long that is.
  const first = kind === "scored_move" || (shown !== undefined && isMove(shown));
  return (
    <Page name="Tune">
      <DeviceNotice device={device} />
      <div className="columns design until-75">
        <div className="column">
          <WishCard device={device} axis={axis} changes={changes} busy={runs} />
          <StudyList
            studies={own}
            error={studies.error}
            shown={shown?.id ?? null}
            onPick={pick}
            retry={() => void studies.refetch()}
          />
        </div>
        <div className={`column ${runs || (shown && shown.id === picked) ? "ahead" : ""}`}>
          {first && ranking}
          <StudyView id={shown?.id ?? null} changes={changes} />
          {!first && ranking}
        </div>
      </div>
    </Page>
  );
}

const pick = (study: string) => putIntoAddress({ study }, "step");
