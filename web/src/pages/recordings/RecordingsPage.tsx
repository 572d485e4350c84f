import { Redirect, Route, Switch } from "wouter";
import { CompareView } from "./CompareView";
import { ListView } from "./ListView";
import { RecordingView } from "./RecordingView";
import { ReportView } from "./ReportView";

/** What was recorded: all of it, one, several on each other, or several as a report. */
export default function RecordingsPage() {
  return (
    <Switch>
      <Route path="/recordings" component={ListView} />
      <Route path="/recordings/compare" component={CompareView} />
      <Route path="/recordings/report" component={ReportView} />
      <Route path="/recordings/:id">{({ id }) => <RecordingView key={id} id={id} />}</Route>
      <Route>
        <Redirect to="/recordings" replace />
      </Route>
    </Switch>
  );
}
