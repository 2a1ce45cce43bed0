BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0002');
CREATE TABLE attempts (
	id INTEGER NOT NULL, 
	case_id VARCHAR, 
	user_id VARCHAR, 
	"trigger" VARCHAR NOT NULL, 
	accepted BOOLEAN NOT NULL, 
	code VARCHAR NOT NULL, 
	message VARCHAR NOT NULL, 
	state VARCHAR, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_attempts PRIMARY KEY (id), 
	CONSTRAINT fk_attempts_case_id FOREIGN KEY(case_id) REFERENCES cases (id)
);
INSERT INTO "attempts" VALUES(1,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.688159Z');
INSERT INTO "attempts" VALUES(2,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.699032Z');
INSERT INTO "attempts" VALUES(3,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.717387Z');
INSERT INTO "attempts" VALUES(4,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.725237Z');
INSERT INTO "attempts" VALUES(5,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.734190Z');
INSERT INTO "attempts" VALUES(6,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.744146Z');
INSERT INTO "attempts" VALUES(7,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.757376Z');
INSERT INTO "attempts" VALUES(8,'case-1','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.765254Z');
INSERT INTO "attempts" VALUES(9,'case-1','411a007b21444f2ba8898e548b8d7115','case_closed',1,'taken','','case_open','2026-11-22T09:22:41.775500Z');
INSERT INTO "attempts" VALUES(10,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.781222Z');
INSERT INTO "attempts" VALUES(11,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.789195Z');
INSERT INTO "attempts" VALUES(12,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.797262Z');
INSERT INTO "attempts" VALUES(13,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.805195Z');
INSERT INTO "attempts" VALUES(14,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.809183Z');
INSERT INTO "attempts" VALUES(15,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.817310Z');
INSERT INTO "attempts" VALUES(16,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.825206Z');
INSERT INTO "attempts" VALUES(17,'case-2','411a007b21444f2ba8898e548b8d7115','plan_requested',1,'taken','','case_open','2026-11-22T09:22:41.829650Z');
INSERT INTO "attempts" VALUES(18,'case-2','411a007b21444f2ba8898e548b8d7115','case_closed',1,'taken','','case_open','2026-11-22T09:22:41.837201Z');
CREATE TABLE audit_events (
	id INTEGER NOT NULL, 
	kind VARCHAR NOT NULL, 
	user_id VARCHAR, 
	data JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_audit_events PRIMARY KEY (id)
);
INSERT INTO "audit_events" VALUES(1,'user_added',NULL,'{"name":"anna","role":"surgeon","user_id":"411a007b21444f2ba8898e548b8d7115"}','2026-11-22T09:22:41.614406Z');
INSERT INTO "audit_events" VALUES(2,'signed_in','411a007b21444f2ba8898e548b8d7115','{"session":"s-1"}','2026-11-22T09:22:41.640790Z');
INSERT INTO "audit_events" VALUES(3,'signed_out','411a007b21444f2ba8898e548b8d7115','{"session":"s-1"}','2026-11-22T09:22:41.845177Z');
CREATE TABLE cases (
	id VARCHAR NOT NULL, 
	room VARCHAR(64) NOT NULL, 
	patient_id VARCHAR NOT NULL, 
	study_uid VARCHAR NOT NULL, 
	opened_by VARCHAR NOT NULL, 
	product_version VARCHAR NOT NULL, 
	settings_sha256 VARCHAR(64) NOT NULL, 
	devices JSON NOT NULL, 
	opened_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_cases PRIMARY KEY (id), 
	CONSTRAINT fk_cases_opened_by FOREIGN KEY(opened_by) REFERENCES users (id)
);
INSERT INTO "cases" VALUES('case-1','room-0','P1','1.2','411a007b21444f2ba8898e548b8d7115','0.1.0','0000000000000000000000000000000000000000000000000000000000000000','{}','2026-11-22T09:22:41.623215Z');
INSERT INTO "cases" VALUES('case-2','room-1','P1','1.2','411a007b21444f2ba8898e548b8d7115','0.1.0','0000000000000000000000000000000000000000000000000000000000000000','{}','2026-11-22T09:22:41.634204Z');
CREATE TABLE checkpoints (
	sequence INTEGER NOT NULL, 
	statement TEXT NOT NULL, 
	signature VARCHAR(128) NOT NULL, 
	CONSTRAINT pk_checkpoints PRIMARY KEY (sequence), 
	CONSTRAINT fk_checkpoints_sequence FOREIGN KEY(sequence) REFERENCES ledger (sequence)
);
INSERT INTO "checkpoints" VALUES(1,'{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":0,"reason":"ledger_begun","sequence":1,"sha256":"eb8146726d622171582f9672e49d7d4c7f181668ed4300afe9ee212dd8c5e3b2","signed_at":"2026-11-22T09:22:41.598503Z"}','4217ae84d48567e1dfb835b2fba5149ec66516cdf278bee8d36316de8f18494e87757f6331c207be3cd8d34c5ee13afb72588db52bf3267387faa4fa489ac602');
INSERT INTO "checkpoints" VALUES(20,'{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":1,"reason":"case_closed","sequence":20,"sha256":"06aba42ec70e459b9b5e21c209ed65844ee2e898dfb97e84af8226fa6ab8d51d","signed_at":"2026-11-22T09:22:41.777701Z"}','5fecdd826b4a2c1adb897eaf5cea4ec848826c6ce9889b9e7ee048b6e5019eaebcdca630f812d49e16b379dd7cd1b057b593354a9b320b8cf58724a0b9161f0d');
INSERT INTO "checkpoints" VALUES(29,'{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":20,"reason":"case_closed","sequence":29,"sha256":"8ca4e20e1a07974f58d6c887cda7e68bb599873f865b1ead1ab1c5968e14c06d","signed_at":"2026-11-22T09:22:41.839102Z"}','5c0241b6df2fe5e5677f4b3f4af2214512fce85f77d767e50afaf39b20676ef81664f5f50f7ff4e114794f10107b89e592391887aa5ceba26ed4de7764d0fa08');
CREATE TABLE device_files (
	id VARCHAR NOT NULL, 
	kind VARCHAR(8) NOT NULL, 
	name VARCHAR NOT NULL, 
	version VARCHAR NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	expires VARCHAR(10), 
	content BLOB NOT NULL, 
	uploaded_by VARCHAR NOT NULL, 
	position INTEGER NOT NULL, 
	uploaded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_device_files PRIMARY KEY (id), 
	CONSTRAINT fk_device_files_uploaded_by FOREIGN KEY(uploaded_by) REFERENCES users (id), 
	CONSTRAINT uq_device_files_kind_name_version UNIQUE (kind, name, version), 
	CONSTRAINT uq_device_files_position UNIQUE (position)
);
INSERT INTO "device_files" VALUES('device-1','tcp','tool','1','ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff',NULL,X'6E616D65203D2031','411a007b21444f2ba8898e548b8d7115',1,'2026-01-01T00:00:00.000000Z');
CREATE TABLE evaluations (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	image_id VARCHAR NOT NULL, 
	CONSTRAINT pk_evaluations PRIMARY KEY (id), 
	CONSTRAINT fk_evaluations_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_evaluations_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "evaluations" VALUES('case-1-evaluations','case-1',8,'[]','{"value":0.1234567}','2026-11-22T09:22:41.758454Z','ef39de0bd39f4542945872df5431bb83');
INSERT INTO "evaluations" VALUES('case-2-evaluations','case-2',8,'[]','{"value":0.1234567}','2026-11-22T09:22:41.826169Z','ef39de0bd39f4542945872df5431bb83');
CREATE TABLE events (
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	version INTEGER NOT NULL, 
	"trigger" VARCHAR NOT NULL, 
	user_id VARCHAR, 
	state VARCHAR NOT NULL, 
	case_state JSON NOT NULL, 
	data JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_events PRIMARY KEY (case_id, sequence), 
	CONSTRAINT fk_events_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_events_user_id FOREIGN KEY(user_id) REFERENCES users (id)
);
INSERT INTO "events" VALUES('case-1',1,1,'case_opened','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.626172Z');
INSERT INTO "events" VALUES('case-2',1,1,'case_opened','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.634760Z');
INSERT INTO "events" VALUES('case-1',2,2,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.690831Z');
INSERT INTO "events" VALUES('case-1',3,3,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.700035Z');
INSERT INTO "events" VALUES('case-1',4,4,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.718559Z');
INSERT INTO "events" VALUES('case-1',5,5,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.726250Z');
INSERT INTO "events" VALUES('case-1',6,6,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.735115Z');
INSERT INTO "events" VALUES('case-1',7,7,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.745274Z');
INSERT INTO "events" VALUES('case-1',8,8,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.758454Z');
INSERT INTO "events" VALUES('case-1',9,9,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.766235Z');
INSERT INTO "events" VALUES('case-1',10,10,'case_closed','411a007b21444f2ba8898e548b8d7115','closed','{}','{}','2026-11-22T09:22:41.776490Z');
INSERT INTO "events" VALUES('case-2',2,2,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.782156Z');
INSERT INTO "events" VALUES('case-2',3,3,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.790330Z');
INSERT INTO "events" VALUES('case-2',4,4,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.798190Z');
INSERT INTO "events" VALUES('case-2',5,5,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.806105Z');
INSERT INTO "events" VALUES('case-2',6,6,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.810125Z');
INSERT INTO "events" VALUES('case-2',7,7,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.818261Z');
INSERT INTO "events" VALUES('case-2',8,8,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.826169Z');
INSERT INTO "events" VALUES('case-2',9,9,'x','411a007b21444f2ba8898e548b8d7115','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:41.830525Z');
INSERT INTO "events" VALUES('case-2',10,10,'note','411a007b21444f2ba8898e548b8d7115','case_open','{}','{}','2026-11-22T09:22:41.838089Z');
CREATE TABLE idempotency_keys (
	user_id VARCHAR NOT NULL, 
	"key" VARCHAR(128) NOT NULL, 
	request_sha256 VARCHAR(64) NOT NULL, 
	status INTEGER NOT NULL, 
	body JSON NOT NULL, 
	version INTEGER, 
	created_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_idempotency_keys PRIMARY KEY (user_id, "key")
);
CREATE TABLE image_bytes (
	sha256 VARCHAR(64) NOT NULL, 
	content BLOB NOT NULL, 
	CONSTRAINT pk_image_bytes PRIMARY KEY (sha256)
);
INSERT INTO "image_bytes" VALUES('cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6',X'696D6167652030');
INSERT INTO "image_bytes" VALUES('bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b',X'696D6167652031');
INSERT INTO "image_bytes" VALUES('32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9',X'696D6167652032');
CREATE TABLE image_purposes (
	image_id VARCHAR NOT NULL, 
	case_id VARCHAR, 
	purpose VARCHAR NOT NULL, 
	arm JSON NOT NULL, 
	verdicts JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_image_purposes PRIMARY KEY (image_id), 
	CONSTRAINT fk_image_purposes_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_image_purposes_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "image_purposes" VALUES('220fc9a20759441fbaeebc5442a9a1d9','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:41.659544Z');
INSERT INTO "image_purposes" VALUES('ef39de0bd39f4542945872df5431bb83','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:41.672007Z');
INSERT INTO "image_purposes" VALUES('2aeb08d930e54b21849f8f6f95888d60','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:41.679983Z');
CREATE TABLE images (
	id VARCHAR NOT NULL, 
	position INTEGER NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	sop_uid VARCHAR, 
	pixel_sha256 VARCHAR(64), 
	duplicate_of VARCHAR, 
	patient_id VARCHAR, 
	study_uid VARCHAR, 
	problem JSON, 
	source JSON NOT NULL, 
	metadata JSON NOT NULL, 
	received_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_images PRIMARY KEY (id), 
	CONSTRAINT fk_images_duplicate_of FOREIGN KEY(duplicate_of) REFERENCES images (id), 
	CONSTRAINT fk_images_sha256 FOREIGN KEY(sha256) REFERENCES image_bytes (sha256), 
	CONSTRAINT uq_images_position UNIQUE (position)
);
INSERT INTO "images" VALUES('220fc9a20759441fbaeebc5442a9a1d9',1,'cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6','1.0','1.2',NULL,'0000000000000000000000000000000000000000000000000000000000000000','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:41.650806Z');
INSERT INTO "images" VALUES('ef39de0bd39f4542945872df5431bb83',2,'bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b','1.1','1.2','220fc9a20759441fbaeebc5442a9a1d9','1111111111111111111111111111111111111111111111111111111111111111','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:41.664447Z');
INSERT INTO "images" VALUES('2aeb08d930e54b21849f8f6f95888d60',3,'32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9','1.2','1.2','220fc9a20759441fbaeebc5442a9a1d9','2222222222222222222222222222222222222222222222222222222222222222','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:41.675789Z');
CREATE TABLE insertions (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_insertions PRIMARY KEY (id), 
	CONSTRAINT fk_insertions_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "insertions" VALUES('case-1-insertions','case-1',9,'[]','{"value":0.1234567}','2026-11-22T09:22:41.766235Z');
INSERT INTO "insertions" VALUES('case-2-insertions','case-2',9,'[]','{"value":0.1234567}','2026-11-22T09:22:41.830525Z');
CREATE TABLE leases (
	case_id VARCHAR NOT NULL, 
	fencing_token INTEGER NOT NULL, 
	session_id VARCHAR NOT NULL, 
	user_id VARCHAR NOT NULL, 
	reason VARCHAR NOT NULL, 
	taken_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_leases PRIMARY KEY (case_id), 
	CONSTRAINT fk_leases_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_leases_session_id FOREIGN KEY(session_id) REFERENCES sessions (id), 
	CONSTRAINT fk_leases_user_id FOREIGN KEY(user_id) REFERENCES users (id)
);
CREATE TABLE ledger (
	sequence INTEGER NOT NULL, 
	entry TEXT NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	reached_at VARCHAR(32) NOT NULL, 
	case_id VARCHAR, 
	actor VARCHAR, 
	action VARCHAR NOT NULL, 
	attempt_id INTEGER, 
	CONSTRAINT pk_ledger PRIMARY KEY (sequence), 
	CONSTRAINT uq_ledger_attempt_id UNIQUE (attempt_id)
);
INSERT INTO "ledger" VALUES(1,'{"action":"ledger_begun","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101714867,"payload":{"product_version":"0.1.0"},"previous":"0000000000000000000000000000000000000000000000000000000000000000","recorded_at":"2026-11-22T09:22:41.563686Z","role":null,"rows":{},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":1}','eb8146726d622171582f9672e49d7d4c7f181668ed4300afe9ee212dd8c5e3b2','2026-11-22T09:22:41.563686Z',NULL,NULL,'ledger_begun',NULL);
INSERT INTO "ledger" VALUES(2,'{"action":"user_added","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101767036,"payload":{"name":"anna","role":"surgeon","user_id":"411a007b21444f2ba8898e548b8d7115"},"previous":"eb8146726d622171582f9672e49d7d4c7f181668ed4300afe9ee212dd8c5e3b2","recorded_at":"2026-11-22T09:22:41.615885Z","role":null,"rows":{"audit_events":[[[1],"ea8be78724315526063eeba63263a774a0a6e8e1dcafb1f6a9ed0fa6e04be5ae"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":2}','81ba97c18d2408eb44cce42a7153aa10919fa0eeab4a10297f0b474b21cbfb74','2026-11-22T09:22:41.615885Z',NULL,NULL,'user_added',NULL);
INSERT INTO "ledger" VALUES(3,'{"action":"case_opened","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":null,"before":null,"case_id":"case-1","client":"service","monotonic_us":28101779056,"payload":{},"previous":"81ba97c18d2408eb44cce42a7153aa10919fa0eeab4a10297f0b474b21cbfb74","recorded_at":"2026-11-22T09:22:41.627425Z","role":"surgeon","rows":{"cases":[[["case-1"],"59bd1325952245978aa939fa0c56b7f7104fc65364b4a865433a0201cb10e615"]],"events":[[["case-1",1],"5766467d3cd5cc3f50bcf4ce9b5ee6011a9b2288e170b3f86a1780afce0b90f8"]],"planned_targets":[[["case-1"],"66374241f5e006d09b930e48a6a2234cbdee3eb72169779b3c119ccba5e4f86a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":3}','1f180f3e0b8cd71fc463c1dd03f23845f5627684d19341b42ffc0f2ef3f70cde','2026-11-22T09:22:41.627425Z','case-1','411a007b21444f2ba8898e548b8d7115','case_opened',NULL);
INSERT INTO "ledger" VALUES(4,'{"action":"case_opened","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":null,"before":null,"case_id":"case-2","client":"service","monotonic_us":28101786454,"payload":{},"previous":"1f180f3e0b8cd71fc463c1dd03f23845f5627684d19341b42ffc0f2ef3f70cde","recorded_at":"2026-11-22T09:22:41.635166Z","role":"surgeon","rows":{"cases":[[["case-2"],"5e4d0aca20d3d1bb8a047b36ba4710eafd58b8a2a45c9cf7d902a081f9030185"]],"events":[[["case-2",1],"01f48a200cd18ce4762e537bdef0cddbeeb80e3c09a52cc8ca54267f0293e2d4"]],"planned_targets":[[["case-2"],"5abcff4f13d170442ba6e0a3381989c83696dc1add271ef6bf285dd04f69513a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":4}','2910ccb43d90988084ba6a3d7651b22432e180b06f2f3b3fb4c2839df64084be','2026-11-22T09:22:41.635166Z','case-2','411a007b21444f2ba8898e548b8d7115','case_opened',NULL);
INSERT INTO "ledger" VALUES(5,'{"action":"signed_in","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101793474,"payload":{"session":"s-1"},"previous":"2910ccb43d90988084ba6a3d7651b22432e180b06f2f3b3fb4c2839df64084be","recorded_at":"2026-11-22T09:22:41.642169Z","role":"surgeon","rows":{"audit_events":[[[2],"b57de63e6f147f323d006d4d7a89b1f328aa556d84fd87158c7732338d08ba59"]],"device_files":[[["device-1"],"b77155b18ff0564b18ae4f6f0fbc1cc201eda10a8365ebd509b7c72d5b2b3650"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":5}','117f52eedad1e09d5fef91f68b983ee56a764aab812a9e0315c66a2841baf2ca','2026-11-22T09:22:41.642169Z',NULL,'411a007b21444f2ba8898e548b8d7115','signed_in',NULL);
INSERT INTO "ledger" VALUES(6,'{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101803039,"payload":{"image_id":"220fc9a20759441fbaeebc5442a9a1d9","sha256":"cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6"},"previous":"117f52eedad1e09d5fef91f68b983ee56a764aab812a9e0315c66a2841baf2ca","recorded_at":"2026-11-22T09:22:41.651893Z","role":null,"rows":{"image_bytes":[[["cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6"],"6f32b590e03e5f95f7466d7d31d6f8771fd362417b52041224fc88c1bc82cb45"]],"images":[[["220fc9a20759441fbaeebc5442a9a1d9"],"52ff79065e429745092445260dde32812171943208c08678fca2bc1708bcd3cb"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":6}','6ec1bb29f57898180453841e4b7d8ab6fcc796a7ee0b55bcd47a6f29ca6d2704','2026-11-22T09:22:41.651893Z',NULL,NULL,'image_stored',NULL);
INSERT INTO "ledger" VALUES(7,'{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101811776,"payload":{"image_id":"220fc9a20759441fbaeebc5442a9a1d9","purpose":"registration"},"previous":"6ec1bb29f57898180453841e4b7d8ab6fcc796a7ee0b55bcd47a6f29ca6d2704","recorded_at":"2026-11-22T09:22:41.660630Z","role":null,"rows":{"image_purposes":[[["220fc9a20759441fbaeebc5442a9a1d9"],"02631049c9f54207cb6f47596171f50f72f867a903ec0eb236f521c8bfefcdd2"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":7}','eb407a18f8a7508aec90be2d51e2255b6bfc283536aaa080c7ecb59cc927a0a8','2026-11-22T09:22:41.660630Z',NULL,NULL,'recorded',NULL);
INSERT INTO "ledger" VALUES(8,'{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101816871,"payload":{"image_id":"ef39de0bd39f4542945872df5431bb83","sha256":"bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b"},"previous":"eb407a18f8a7508aec90be2d51e2255b6bfc283536aaa080c7ecb59cc927a0a8","recorded_at":"2026-11-22T09:22:41.665718Z","role":null,"rows":{"image_bytes":[[["bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b"],"4335f878bb8196cfb933c23eb54b9e69f85fbc2205907cb07f4e20e4115a1792"]],"images":[[["ef39de0bd39f4542945872df5431bb83"],"a9e62691797e32fc53196eefc8a9808ca0c87c3631ad45bdd2dd8f3a13138c3c"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":8}','57e5403c0ff6f8a471404cb11ec8e7154fefd77ddb41d7e84207b67a451a8a90','2026-11-22T09:22:41.665718Z',NULL,NULL,'image_stored',NULL);
INSERT INTO "ledger" VALUES(9,'{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101823708,"payload":{"image_id":"ef39de0bd39f4542945872df5431bb83","purpose":"registration"},"previous":"57e5403c0ff6f8a471404cb11ec8e7154fefd77ddb41d7e84207b67a451a8a90","recorded_at":"2026-11-22T09:22:41.672568Z","role":null,"rows":{"image_purposes":[[["ef39de0bd39f4542945872df5431bb83"],"b102cf64005b9a8b527cd8562bfcf6776fd94c5878b4ccfd4fba929ecbdf4da2"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":9}','5f13d7fea7fe51065effc01ec5010bb07b85edeed01f04e230bd06b86dab75a7','2026-11-22T09:22:41.672568Z',NULL,NULL,'recorded',NULL);
INSERT INTO "ledger" VALUES(10,'{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101827345,"payload":{"image_id":"2aeb08d930e54b21849f8f6f95888d60","sha256":"32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9"},"previous":"5f13d7fea7fe51065effc01ec5010bb07b85edeed01f04e230bd06b86dab75a7","recorded_at":"2026-11-22T09:22:41.676207Z","role":null,"rows":{"image_bytes":[[["32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9"],"0a43423277303a1e348c4dc2cd31208bd735a4e1c0766f499d66a883b0f17a7e"]],"images":[[["2aeb08d930e54b21849f8f6f95888d60"],"0ec0c1d54d437329dbe96612684ddd4a66af32e4cb2fc209b76d6c623257c498"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":10}','d5c46397063d1ae80e6b29f0dd7138605363b05be565a9ac99fab5d60b6ec2d1','2026-11-22T09:22:41.676207Z',NULL,NULL,'image_stored',NULL);
INSERT INTO "ledger" VALUES(11,'{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101831633,"payload":{"image_id":"2aeb08d930e54b21849f8f6f95888d60","purpose":"registration"},"previous":"d5c46397063d1ae80e6b29f0dd7138605363b05be565a9ac99fab5d60b6ec2d1","recorded_at":"2026-11-22T09:22:41.680494Z","role":null,"rows":{"image_purposes":[[["2aeb08d930e54b21849f8f6f95888d60"],"de2a185f1fe9531ddb96131539b2737a7b511b7c49e94680b5726cfec2ee3a7f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":11}','94f8c79093bc06e9eef71cbf2757bbea75ed63ce666a3598d3a43f9fa3a47c7a','2026-11-22T09:22:41.680494Z',NULL,NULL,'recorded',NULL);
INSERT INTO "ledger" VALUES(12,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-registrations"],"attempt_id":1,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101843206,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"94f8c79093bc06e9eef71cbf2757bbea75ed63ce666a3598d3a43f9fa3a47c7a","recorded_at":"2026-11-22T09:22:41.691914Z","role":"surgeon","rows":{"attempts":[[[1],"86cba86569346dc1573348f97ac9b3b3e52fb6878a2f27e6d5b56296fca6e65a"]],"events":[[["case-1",2],"dfb02f9bdbb2500ad62cc9610d604847b90138fe70b27f7ff22100d9763930a6"]],"registrations":[[["case-1-registrations"],"786dc664e540cd0f82d1e37ad006be8b535e7f61f55114d1baa0374ea463f878"]],"verdicts":[[[1],"0b13e236eca93655a0117e749d41a1ff0aae6dec0a4e58c886b13c1674c86e5c"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":12}','98405bb9d916ed6810edd022e4c70ae2e7700d95434fe20223255677ddbed422','2026-11-22T09:22:41.691914Z','case-1','411a007b21444f2ba8898e548b8d7115','x',1);
INSERT INTO "ledger" VALUES(13,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-targets"],"attempt_id":2,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101855440,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"98405bb9d916ed6810edd022e4c70ae2e7700d95434fe20223255677ddbed422","recorded_at":"2026-11-22T09:22:41.704122Z","role":"surgeon","rows":{"attempts":[[[2],"f4a282b91f40fb01492eb2b976b4fd5c541dcd236f690e14c09afae9d4197989"]],"events":[[["case-1",3],"d6081e61a0e7b16102ac39c1148811fbd1d1ef3f216dbef494f202f02464967c"]],"targets":[[["case-1-targets"],"307a1ce0efb6dcec532d92c1999415e8d274af99676ab2cf1795d5c9d5fa1a70"]],"verdicts":[[[2],"85f55739cfe0328e68afbea1e83516bcbcbe4f713308f6b534d2e787a78cc6d9"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":13}','4ab0b1aa3932555b740529f7edc3cc6309989b40011d8b5a6898c6a1e01994d5','2026-11-22T09:22:41.704122Z','case-1','411a007b21444f2ba8898e548b8d7115','x',2);
INSERT INTO "ledger" VALUES(14,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-plans"],"attempt_id":3,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101870993,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"4ab0b1aa3932555b740529f7edc3cc6309989b40011d8b5a6898c6a1e01994d5","recorded_at":"2026-11-22T09:22:41.719701Z","role":"surgeon","rows":{"attempts":[[[3],"863d30b92be34b314c242d0beb767cf896fde2902e5aeac8fd347036c8e73f19"]],"events":[[["case-1",4],"3a037cad0488a5f4a695dd5589f85b01ed3f4d8e9898e9b74c9b311fcbab557a"]],"plans":[[["case-1-plans"],"9d539542ba1b16bb6b64e8ea5ec71ab175bffd50f4ac638c58438225504a7210"]],"verdicts":[[[3],"a2be642e1c7179feeb3756d3cd90e97287815426405aeccbc56612f8b933ed93"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":14}','17954b40cf61e55d84e6712a0531a5c8d0fe10ca2b08c8f287306fe15387022a','2026-11-22T09:22:41.719701Z','case-1','411a007b21444f2ba8898e548b8d7115','x',3);
INSERT INTO "ledger" VALUES(15,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-permits"],"attempt_id":4,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101881170,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"17954b40cf61e55d84e6712a0531a5c8d0fe10ca2b08c8f287306fe15387022a","recorded_at":"2026-11-22T09:22:41.727519Z","role":"surgeon","rows":{"attempts":[[[4],"54a3c69631270380103ea8999768c9190a21e657da7524676f49249706daef47"]],"events":[[["case-1",5],"b1737a5f05320b3b732810e7e63a0be190250f106ea91d16fce4338e927ae269"]],"permits":[[["case-1-permits"],"6395a1f0253f0579c031022b3690c76cb4389bc4342185874305ad669685b67b"]],"verdicts":[[[4],"306cc1923738d0c6be8a630dffd7eef039bb7360d8b9b9e51c6e095bf0c57fc9"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":15}','57b1ef4d941b5d1102bb54c5cc77edcf8521206782d77a0647bc185247df7893','2026-11-22T09:22:41.727519Z','case-1','411a007b21444f2ba8898e548b8d7115','x',4);
INSERT INTO "ledger" VALUES(16,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-permits"],"attempt_id":5,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101890075,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"57b1ef4d941b5d1102bb54c5cc77edcf8521206782d77a0647bc185247df7893","recorded_at":"2026-11-22T09:22:41.738770Z","role":"surgeon","rows":{"attempts":[[[5],"6ea1e4d1bc6d9255ab77ff03c3f4796b481b3ec99d17bc6e09caaa05a7e0ab84"]],"events":[[["case-1",6],"19ce18aad9263af9bea25768468dc65ff673f0f582a6af16b3a1dd67ed6e9651"]],"permit_uses":[[["case-1-permits"],"4b887d4a96284b572535ec4bb04f322c54b2644e10d9219ae660ddc30f06ab1c"]],"verdicts":[[[5],"448c569e1891f4cfd582045c0a36fbaeee42160c90f7246085408cad5380cf78"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":16}','ea724f39e47adb7658080662998e190d92fca6f9edb61001b747fa87f86f3757','2026-11-22T09:22:41.738770Z','case-1','411a007b21444f2ba8898e548b8d7115','x',5);
INSERT INTO "ledger" VALUES(17,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-motions"],"attempt_id":6,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101897720,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"ea724f39e47adb7658080662998e190d92fca6f9edb61001b747fa87f86f3757","recorded_at":"2026-11-22T09:22:41.746429Z","role":"surgeon","rows":{"attempts":[[[6],"dbfb8be82d6648a12e41880bfdaebcf748a2ab6661e84cd2b0ab43c112f93f42"]],"events":[[["case-1",7],"da72ac607e99f392b7ac1996c1d955d83c590a4e8e9f86bcc7d326d56d86d178"]],"motions":[[["case-1-motions"],"b73696c1375ada84f4dc99a17deb6a2031fcbebbf38f49479b9a9895b990b729"]],"verdicts":[[[6],"5747891d7b29af9b1e3fd8b37416bb13a5de97f60049c5071902d5f231bf1694"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":17}','f8e9a702401499fe59508f1a38f1b872d846bf537e1996cb5c6208aaf8f43615','2026-11-22T09:22:41.746429Z','case-1','411a007b21444f2ba8898e548b8d7115','x',6);
INSERT INTO "ledger" VALUES(18,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-evaluations"],"attempt_id":7,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101911065,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"f8e9a702401499fe59508f1a38f1b872d846bf537e1996cb5c6208aaf8f43615","recorded_at":"2026-11-22T09:22:41.759769Z","role":"surgeon","rows":{"attempts":[[[7],"b3410a86625f4e0a8c921fb860faa4083ca971b5934c79cc4cad08eb064b7d88"]],"evaluations":[[["case-1-evaluations"],"598247df96d37629fb9b73aa14a3813b36b3ef0f7a56581bb42003bce0eda6bf"]],"events":[[["case-1",8],"2d8a70b97a250968a2b3a2e46b9941f27b86d937ed30b096e6c1fc7c4c53570d"]],"verdicts":[[[7],"29e0327fdcb271e96bad41b1731f56e080f1a161e5474832ce8848774219c80b"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":18}','85ffb49e12d2975ca5a8bdd246331d1a5ab0954dc1b8dc7896b78db570c4c826','2026-11-22T09:22:41.759769Z','case-1','411a007b21444f2ba8898e548b8d7115','x',7);
INSERT INTO "ledger" VALUES(19,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-1-insertions"],"attempt_id":8,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101918702,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"85ffb49e12d2975ca5a8bdd246331d1a5ab0954dc1b8dc7896b78db570c4c826","recorded_at":"2026-11-22T09:22:41.767410Z","role":"surgeon","rows":{"attempts":[[[8],"0e0cb3c47703024a09ecfcd8b98e577ffdec9c71b70a03c69ec1c13d3e86fcb8"]],"events":[[["case-1",9],"42db3aef29409624686537bd7ff374ab35568a7cde496d1f48f153f7babba732"]],"insertions":[[["case-1-insertions"],"6d340e2cb76f9335f43c3bf9dd5f2d6fcdff28df02da7f3d700146f1c8dcacd7"]],"verdicts":[[[8],"34a1b3110649412415451458c7bd4561b8538276a4dfcb8bdb68ce137bd2be19"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":19}','ca9f9abce222079dc979872466ca6f7716b30e6fb1be185e7590f7c659c4f92e','2026-11-22T09:22:41.767410Z','case-1','411a007b21444f2ba8898e548b8d7115','x',8);
INSERT INTO "ledger" VALUES(20,'{"action":"case_closed","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"closed","artefacts":[],"attempt_id":9,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28101928227,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"ca9f9abce222079dc979872466ca6f7716b30e6fb1be185e7590f7c659c4f92e","recorded_at":"2026-11-22T09:22:41.776840Z","role":"surgeon","rows":{"attempts":[[[9],"442eb4a6bdeb1fb2effc9d4ac5e754a85e493f49044d3c0d90f5aa50ec0b6516"]],"events":[[["case-1",10],"90b03e5227a87ce726e5bf8a1d5a686e70d8422e3508c2227f806972b2b31587"]],"verdicts":[[[9],"f5aa69f00e06e4e635545ad5c763284b1cb980122739ef3e66a8ba5e5259f7e4"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":20}','06aba42ec70e459b9b5e21c209ed65844ee2e898dfb97e84af8226fa6ab8d51d','2026-11-22T09:22:41.776840Z','case-1','411a007b21444f2ba8898e548b8d7115','case_closed',9);
INSERT INTO "ledger" VALUES(21,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-registrations"],"attempt_id":10,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101933959,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"06aba42ec70e459b9b5e21c209ed65844ee2e898dfb97e84af8226fa6ab8d51d","recorded_at":"2026-11-22T09:22:41.782683Z","role":"surgeon","rows":{"attempts":[[[10],"1c962772144656e20981092269a96bdba85ada23e721bc15553166bb6e9025f5"]],"events":[[["case-2",2],"03e98a530dc273e4ee75483a9c675043852bea8f71811b6fc77ce52523159295"]],"registrations":[[["case-2-registrations"],"f87882fbd906e38456fdd889df3647f45a7428b141ee181ae3a39525cde2355f"]],"verdicts":[[[10],"01992551197f9dc7273ac26b7bb4dd74a7e49bc2308900f6d6c67935166e6f29"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":21}','a457a6d596c2e1ec754b0c694f8cb186003596991b494840ffb02678abadec06','2026-11-22T09:22:41.782683Z','case-2','411a007b21444f2ba8898e548b8d7115','x',10);
INSERT INTO "ledger" VALUES(22,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-targets"],"attempt_id":11,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101942148,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"a457a6d596c2e1ec754b0c694f8cb186003596991b494840ffb02678abadec06","recorded_at":"2026-11-22T09:22:41.790866Z","role":"surgeon","rows":{"attempts":[[[11],"ae54a2f6dde793340823543e62efb0386b81d12669ea5341d4c63888bd1d91de"]],"events":[[["case-2",3],"5b6f2a24497c622613c171a638697a56f6cccba5606a53dc49ef47ed8c6ab698"]],"targets":[[["case-2-targets"],"db9cd46f3cef9d0b405d0283ae7c3b7d8abe86014fc505d5f06a7646987c338a"]],"verdicts":[[[11],"cdc19229d457497eda87c95cf2df22a93d0da76b42e0d9ee9a905ea40b83a15b"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":22}','11d6537076e36ef79c89e569bd1e75a74754b9012237aa0bec5eddd26fd1705e','2026-11-22T09:22:41.790866Z','case-2','411a007b21444f2ba8898e548b8d7115','x',11);
INSERT INTO "ledger" VALUES(23,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-plans"],"attempt_id":12,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101950042,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"11d6537076e36ef79c89e569bd1e75a74754b9012237aa0bec5eddd26fd1705e","recorded_at":"2026-11-22T09:22:41.798763Z","role":"surgeon","rows":{"attempts":[[[12],"f9e6a0390849297151225e5a48c4dcabc8403ffde1b209765d267cff678d33cf"]],"events":[[["case-2",4],"9125704e93ed6a953861ccc1ac82eaf0d7dd8ac13fb71a66748cea1aa14e415b"]],"plans":[[["case-2-plans"],"a5394fd347ada004b8c0f9d1d3fcbb55367124b03f240d476dcd64f02037d323"]],"verdicts":[[[12],"9d05469efa902549a1b6eea502553bdb1d7773e529c346a276160ae1b7c155f6"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":23}','860bea514afb950db62c5185ad920f02375e2114a2e866eee6e419ca44c700cc','2026-11-22T09:22:41.798763Z','case-2','411a007b21444f2ba8898e548b8d7115','x',12);
INSERT INTO "ledger" VALUES(24,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-permits"],"attempt_id":13,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101957903,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"860bea514afb950db62c5185ad920f02375e2114a2e866eee6e419ca44c700cc","recorded_at":"2026-11-22T09:22:41.806634Z","role":"surgeon","rows":{"attempts":[[[13],"fa36dbc2db4c10de064545e4e4206a33b7ec8d56e30ae25b76811fe847db3cac"]],"events":[[["case-2",5],"525848b8a8f976e76074c84310502ced64471c842bdced2261871d2b46d8508d"]],"permits":[[["case-2-permits"],"57c5cd8446fb39ba38ed2c87f4ef75b414bd0d52966fa9977d94b25bc22175d2"]],"verdicts":[[[13],"586028e0eecd492b74e750d3b5b332910a26f30f61af3f1b2cea9af394376a5a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":24}','f3e6537c909de56bd6813d1024e1c5d9f151e8ca6dca04636b6f94cbb24d2c9e','2026-11-22T09:22:41.806634Z','case-2','411a007b21444f2ba8898e548b8d7115','x',13);
INSERT INTO "ledger" VALUES(25,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-permits"],"attempt_id":14,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101961937,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"f3e6537c909de56bd6813d1024e1c5d9f151e8ca6dca04636b6f94cbb24d2c9e","recorded_at":"2026-11-22T09:22:41.810670Z","role":"surgeon","rows":{"attempts":[[[14],"fb57a8945e4ebd1900bb1c5ee94d161fc4117d7f69694a1b973d813ba3946ee3"]],"events":[[["case-2",6],"9e1e9638d615d9d912e9abecf901d97b04884fe97ab0ca9e1e516f125e4bafb7"]],"permit_uses":[[["case-2-permits"],"f4a4d4cdc750a4ca3f53faf4b17f65739ef8833ff9479286cf2a0aaace26a6db"]],"verdicts":[[[14],"3cd2798cc974ac8bc1d0403c6663b0dbe6f99d40e75d8cfced2ada333f1dfee2"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":25}','0e7622405cafb059295c38ca5c0d775f7a7ebc89cef0a9b6a7d1d7d8d5688a43','2026-11-22T09:22:41.810670Z','case-2','411a007b21444f2ba8898e548b8d7115','x',14);
INSERT INTO "ledger" VALUES(26,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-motions"],"attempt_id":15,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101970186,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"0e7622405cafb059295c38ca5c0d775f7a7ebc89cef0a9b6a7d1d7d8d5688a43","recorded_at":"2026-11-22T09:22:41.818892Z","role":"surgeon","rows":{"attempts":[[[15],"e8fb90adb850e04f7436ce0daccb072def024bdd4dfc14195ef5664c6d8d322d"]],"events":[[["case-2",7],"b1ba44bbb6cbf23dd5e0895fa12bfd658cbe42e2f4d296eed81ec83c339c4fc7"]],"motions":[[["case-2-motions"],"c6057636a0b72c63f6b75912ef2bef61cb82e4f6da62fd2dc856891480f5fa27"]],"verdicts":[[[15],"8832f09d15fd4de679db1555f3db3d2b5b7c9c0dd3bfaebe9ae907c10481c86f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":26}','2045e6d813bdb1a18f58e0efc80d453b2fb6a9f524b5b816e59a0398ef226c3a','2026-11-22T09:22:41.818892Z','case-2','411a007b21444f2ba8898e548b8d7115','x',15);
INSERT INTO "ledger" VALUES(27,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-evaluations"],"attempt_id":16,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101978053,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"2045e6d813bdb1a18f58e0efc80d453b2fb6a9f524b5b816e59a0398ef226c3a","recorded_at":"2026-11-22T09:22:41.826764Z","role":"surgeon","rows":{"attempts":[[[16],"4fedd03c2a3012e21c3fecd8b8261961780e961845bc6a5d84cf51e0e6ca1953"]],"evaluations":[[["case-2-evaluations"],"f3eac7d741b936e06be8f46d076a853a27dcfbf8c4e7fe5170d7833b7b53e8d2"]],"events":[[["case-2",8],"834c7a2829c26c92eaea3c290d21f0a2885fd2a3af33e87c32e0875f63d924ba"]],"verdicts":[[[16],"9407eb4310a50ff069aa5aa39d4489544ef0cf2e6cfc2394dd333fd0340b1b53"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":27}','eee49e7a33b56110694bb00714c3109e0bd2ddabae771f031f6d7da260c59085','2026-11-22T09:22:41.826764Z','case-2','411a007b21444f2ba8898e548b8d7115','x',16);
INSERT INTO "ledger" VALUES(28,'{"action":"x","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":["case-2-insertions"],"attempt_id":17,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101982361,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"eee49e7a33b56110694bb00714c3109e0bd2ddabae771f031f6d7da260c59085","recorded_at":"2026-11-22T09:22:41.831082Z","role":"surgeon","rows":{"attempts":[[[17],"9eae211457ed015cf6abcbcff3dd4035dc36bfa75f59e2396d08b0018538bc9b"]],"events":[[["case-2",9],"4098ebcacb28cc7884e900c2ed9207353d3a738e302e7a68571fdd5be71ced6c"]],"insertions":[[["case-2-insertions"],"154e52958466de9714b9b357f66553c57254bc4c6bdd6437269ea766ca810c0d"]],"verdicts":[[[17],"edfc3862b8ac59258deb1ca229f15baf3a48ba69ad39f46b8c6b000436986519"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":28}','c282e89878ff6fe5d64837a6d4bab1d7f4391686946e59d95c9c9f22fca24777','2026-11-22T09:22:41.831082Z','case-2','411a007b21444f2ba8898e548b8d7115','x',17);
INSERT INTO "ledger" VALUES(29,'{"action":"note","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":18,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28101989709,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"c282e89878ff6fe5d64837a6d4bab1d7f4391686946e59d95c9c9f22fca24777","recorded_at":"2026-11-22T09:22:41.838441Z","role":"surgeon","rows":{"attempts":[[[18],"c4f80c5e2d4f8fe9124fb9115c05f18cba20e781dac6b09b69c89dc55838f354"]],"events":[[["case-2",10],"3ff363e8d362b66f066656e5da4cffccda3f6470f8a3ef2e590bf63c3145b713"]],"verdicts":[[[18],"ef004f3a4b8b398f44ba1400117cd36cf0fcbaedcc5a1a43280514f96579d7a8"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":29}','8ca4e20e1a07974f58d6c887cda7e68bb599873f865b1ead1ab1c5968e14c06d','2026-11-22T09:22:41.838441Z','case-2','411a007b21444f2ba8898e548b8d7115','note',18);
INSERT INTO "ledger" VALUES(30,'{"action":"signed_out","actor":"411a007b21444f2ba8898e548b8d7115","actor_name":"anna","after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28101996996,"payload":{"session":"s-1"},"previous":"8ca4e20e1a07974f58d6c887cda7e68bb599873f865b1ead1ab1c5968e14c06d","recorded_at":"2026-11-22T09:22:41.845708Z","role":"surgeon","rows":{"audit_events":[[[3],"e456a0b7f1574275afc32f08dcbd35565b6bdb8efeafcc50836f6abcca280dae"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":30}','4e4eb4dfd4b95e3bfe8f3d685ec93da6108d6c357f726f3658a63d63a4d720f6','2026-11-22T09:22:41.845708Z',NULL,'411a007b21444f2ba8898e548b8d7115','signed_out',NULL);
CREATE TABLE lock_outs (
	subject VARCHAR NOT NULL, 
	until_s FLOAT NOT NULL, 
	CONSTRAINT pk_lock_outs PRIMARY KEY (subject)
);
CREATE TABLE motions (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	trajectory BLOB, 
	CONSTRAINT pk_motions PRIMARY KEY (id), 
	CONSTRAINT fk_motions_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "motions" VALUES('case-1-motions','case-1',7,'[]','{"value":0.1234567}','2026-11-22T09:22:41.745274Z',X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F202122232425262728292A2B2C2D2E2F303132333435363738393A3B3C3D3E3F');
INSERT INTO "motions" VALUES('case-2-motions','case-2',7,'[]','{"value":0.1234567}','2026-11-22T09:22:41.818261Z',X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F202122232425262728292A2B2C2D2E2F303132333435363738393A3B3C3D3E3F');
CREATE TABLE permit_uses (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_permit_uses PRIMARY KEY (id), 
	CONSTRAINT fk_permit_uses_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_permit_uses_id FOREIGN KEY(id) REFERENCES permits (id)
);
INSERT INTO "permit_uses" VALUES('case-1-permits','case-1',6,'[]','{"value":0.1234567}','2026-11-22T09:22:41.735115Z');
INSERT INTO "permit_uses" VALUES('case-2-permits','case-2',6,'[]','{"value":0.1234567}','2026-11-22T09:22:41.810125Z');
CREATE TABLE permits (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	approved_by VARCHAR NOT NULL, 
	CONSTRAINT pk_permits PRIMARY KEY (id), 
	CONSTRAINT fk_permits_approved_by FOREIGN KEY(approved_by) REFERENCES users (id), 
	CONSTRAINT fk_permits_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "permits" VALUES('case-1-permits','case-1',5,'[]','{"value":0.1234567}','2026-11-22T09:22:41.726250Z','411a007b21444f2ba8898e548b8d7115');
INSERT INTO "permits" VALUES('case-2-permits','case-2',5,'[]','{"value":0.1234567}','2026-11-22T09:22:41.806105Z','411a007b21444f2ba8898e548b8d7115');
CREATE TABLE planned_targets (
	case_id VARCHAR NOT NULL, 
	name VARCHAR NOT NULL, 
	content JSON NOT NULL, 
	CONSTRAINT pk_planned_targets PRIMARY KEY (case_id, name), 
	CONSTRAINT fk_planned_targets_case_id FOREIGN KEY(case_id) REFERENCES cases (id)
);
INSERT INTO "planned_targets" VALUES('case-1','L3','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-1','L4','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-2','L3','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-2','L4','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
CREATE TABLE plans (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_plans PRIMARY KEY (id), 
	CONSTRAINT fk_plans_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "plans" VALUES('case-1-plans','case-1',4,'[]','{"value":0.1234567}','2026-11-22T09:22:41.718559Z');
INSERT INTO "plans" VALUES('case-2-plans','case-2',4,'[]','{"value":0.1234567}','2026-11-22T09:22:41.798190Z');
CREATE TABLE registrations (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	image_id VARCHAR NOT NULL, 
	CONSTRAINT pk_registrations PRIMARY KEY (id), 
	CONSTRAINT fk_registrations_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_registrations_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "registrations" VALUES('case-1-registrations','case-1',2,'[]','{"value":0.1234567}','2026-11-22T09:22:41.690831Z','220fc9a20759441fbaeebc5442a9a1d9');
INSERT INTO "registrations" VALUES('case-2-registrations','case-2',2,'[]','{"value":0.1234567}','2026-11-22T09:22:41.782156Z','220fc9a20759441fbaeebc5442a9a1d9');
CREATE TABLE room_claims (
	room VARCHAR(64) NOT NULL, 
	holder VARCHAR NOT NULL, 
	claimed_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_room_claims PRIMARY KEY (room)
);
CREATE TABLE sessions (
	id VARCHAR NOT NULL, 
	token_sha256 VARCHAR(64) NOT NULL, 
	user_id VARCHAR NOT NULL, 
	created_at VARCHAR(32) NOT NULL, 
	expires_at_s FLOAT NOT NULL, 
	last_seen_at_s FLOAT NOT NULL, 
	locked_at VARCHAR(32), 
	revoked_at VARCHAR(32), 
	CONSTRAINT pk_sessions PRIMARY KEY (id), 
	CONSTRAINT fk_sessions_user_id FOREIGN KEY(user_id) REFERENCES users (id), 
	CONSTRAINT uq_sessions_token_sha256 UNIQUE (token_sha256)
);
CREATE TABLE targets (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_targets PRIMARY KEY (id), 
	CONSTRAINT fk_targets_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "targets" VALUES('case-1-targets','case-1',3,'[]','{"value":0.1234567}','2026-11-22T09:22:41.700035Z');
INSERT INTO "targets" VALUES('case-2-targets','case-2',3,'[]','{"value":0.1234567}','2026-11-22T09:22:41.790330Z');
CREATE TABLE users (
	id VARCHAR NOT NULL, 
	name VARCHAR(64) NOT NULL, 
	role VARCHAR(16) NOT NULL, 
	password_hash VARCHAR NOT NULL, 
	pin_hash VARCHAR NOT NULL, 
	created_at VARCHAR(32) NOT NULL, 
	disabled_at VARCHAR(32), 
	CONSTRAINT pk_users PRIMARY KEY (id), 
	CONSTRAINT uq_users_name UNIQUE (name)
);
INSERT INTO "users" VALUES('411a007b21444f2ba8898e548b8d7115','anna','surgeon','$argon2id$v=19$m=8,t=1,p=1$DG+o97NQ9Y1qnSKyrVhx7g$QPsAK8BpGOebGL42lOIIFBtVm/XCN/NfteD4IY4l4go','$argon2id$v=19$m=8,t=1,p=1$EPACxHrWUvvNDq5Wq0LJwA$grppmukQzKrJoHlEWO2us/IPDff959wgmg1IL/r6T5Q','2026-11-22T09:22:41.613433Z',NULL);
CREATE TABLE verdicts (
	id INTEGER NOT NULL, 
	attempt_id INTEGER NOT NULL, 
	code VARCHAR NOT NULL, 
	hazard VARCHAR NOT NULL, 
	passed BOOLEAN NOT NULL, 
	measured JSON, 
	"limit" JSON, 
	unit VARCHAR NOT NULL, 
	message VARCHAR NOT NULL, 
	CONSTRAINT pk_verdicts PRIMARY KEY (id), 
	CONSTRAINT fk_verdicts_attempt_id FOREIGN KEY(attempt_id) REFERENCES attempts (id)
);
INSERT INTO "verdicts" VALUES(1,1,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(2,1,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(3,2,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(4,2,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(5,3,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(6,3,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(7,4,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(8,4,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(9,5,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(10,5,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(11,6,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(12,6,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(13,7,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(14,7,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(15,8,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(16,8,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(17,9,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(18,9,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(19,10,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(20,10,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(21,11,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(22,11,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(23,12,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(24,12,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(25,13,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(26,13,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(27,14,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(28,14,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(29,15,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(30,15,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(31,16,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(32,16,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(33,17,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(34,17,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(35,18,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(36,18,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
CREATE INDEX ix_images_pixel_sha256 ON images (pixel_sha256);
CREATE INDEX ix_images_sha256 ON images (sha256);
CREATE INDEX ix_images_sop_uid ON images (sop_uid);
CREATE INDEX ix_attempts_case_id ON attempts (case_id);
CREATE INDEX ix_image_purposes_case_id ON image_purposes (case_id);
CREATE INDEX ix_verdicts_attempt_id ON verdicts (attempt_id);
CREATE TRIGGER cases_refuse_update BEFORE UPDATE ON cases BEGIN SELECT RAISE(ABORT, 'cases is append-only'); END;
CREATE TRIGGER cases_refuse_delete BEFORE DELETE ON cases BEGIN SELECT RAISE(ABORT, 'cases is append-only'); END;
CREATE TRIGGER planned_targets_refuse_update BEFORE UPDATE ON planned_targets BEGIN SELECT RAISE(ABORT, 'planned_targets is append-only'); END;
CREATE TRIGGER planned_targets_refuse_delete BEFORE DELETE ON planned_targets BEGIN SELECT RAISE(ABORT, 'planned_targets is append-only'); END;
CREATE TRIGGER events_refuse_update BEFORE UPDATE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER events_refuse_delete BEFORE DELETE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER audit_events_refuse_update BEFORE UPDATE ON audit_events BEGIN SELECT RAISE(ABORT, 'audit_events is append-only'); END;
CREATE TRIGGER audit_events_refuse_delete BEFORE DELETE ON audit_events BEGIN SELECT RAISE(ABORT, 'audit_events is append-only'); END;
CREATE TRIGGER attempts_refuse_update BEFORE UPDATE ON attempts BEGIN SELECT RAISE(ABORT, 'attempts is append-only'); END;
CREATE TRIGGER attempts_refuse_delete BEFORE DELETE ON attempts BEGIN SELECT RAISE(ABORT, 'attempts is append-only'); END;
CREATE TRIGGER verdicts_refuse_update BEFORE UPDATE ON verdicts BEGIN SELECT RAISE(ABORT, 'verdicts is append-only'); END;
CREATE TRIGGER verdicts_refuse_delete BEFORE DELETE ON verdicts BEGIN SELECT RAISE(ABORT, 'verdicts is append-only'); END;
CREATE TRIGGER device_files_refuse_update BEFORE UPDATE ON device_files BEGIN SELECT RAISE(ABORT, 'device_files is append-only'); END;
CREATE TRIGGER device_files_refuse_delete BEFORE DELETE ON device_files BEGIN SELECT RAISE(ABORT, 'device_files is append-only'); END;
CREATE TRIGGER image_bytes_refuse_update BEFORE UPDATE ON image_bytes BEGIN SELECT RAISE(ABORT, 'image_bytes is append-only'); END;
CREATE TRIGGER image_bytes_refuse_delete BEFORE DELETE ON image_bytes BEGIN SELECT RAISE(ABORT, 'image_bytes is append-only'); END;
CREATE TRIGGER images_refuse_update BEFORE UPDATE ON images BEGIN SELECT RAISE(ABORT, 'images is append-only'); END;
CREATE TRIGGER images_refuse_delete BEFORE DELETE ON images BEGIN SELECT RAISE(ABORT, 'images is append-only'); END;
CREATE TRIGGER image_purposes_refuse_update BEFORE UPDATE ON image_purposes BEGIN SELECT RAISE(ABORT, 'image_purposes is append-only'); END;
CREATE TRIGGER image_purposes_refuse_delete BEFORE DELETE ON image_purposes BEGIN SELECT RAISE(ABORT, 'image_purposes is append-only'); END;
CREATE TRIGGER registrations_refuse_update BEFORE UPDATE ON registrations BEGIN SELECT RAISE(ABORT, 'registrations is append-only'); END;
CREATE TRIGGER registrations_refuse_delete BEFORE DELETE ON registrations BEGIN SELECT RAISE(ABORT, 'registrations is append-only'); END;
CREATE TRIGGER targets_refuse_update BEFORE UPDATE ON targets BEGIN SELECT RAISE(ABORT, 'targets is append-only'); END;
CREATE TRIGGER targets_refuse_delete BEFORE DELETE ON targets BEGIN SELECT RAISE(ABORT, 'targets is append-only'); END;
CREATE TRIGGER plans_refuse_update BEFORE UPDATE ON plans BEGIN SELECT RAISE(ABORT, 'plans is append-only'); END;
CREATE TRIGGER plans_refuse_delete BEFORE DELETE ON plans BEGIN SELECT RAISE(ABORT, 'plans is append-only'); END;
CREATE TRIGGER permits_refuse_update BEFORE UPDATE ON permits BEGIN SELECT RAISE(ABORT, 'permits is append-only'); END;
CREATE TRIGGER permits_refuse_delete BEFORE DELETE ON permits BEGIN SELECT RAISE(ABORT, 'permits is append-only'); END;
CREATE TRIGGER permit_uses_refuse_update BEFORE UPDATE ON permit_uses BEGIN SELECT RAISE(ABORT, 'permit_uses is append-only'); END;
CREATE TRIGGER permit_uses_refuse_delete BEFORE DELETE ON permit_uses BEGIN SELECT RAISE(ABORT, 'permit_uses is append-only'); END;
CREATE TRIGGER motions_refuse_update BEFORE UPDATE ON motions BEGIN SELECT RAISE(ABORT, 'motions is append-only'); END;
CREATE TRIGGER motions_refuse_delete BEFORE DELETE ON motions BEGIN SELECT RAISE(ABORT, 'motions is append-only'); END;
CREATE TRIGGER evaluations_refuse_update BEFORE UPDATE ON evaluations BEGIN SELECT RAISE(ABORT, 'evaluations is append-only'); END;
CREATE TRIGGER evaluations_refuse_delete BEFORE DELETE ON evaluations BEGIN SELECT RAISE(ABORT, 'evaluations is append-only'); END;
CREATE TRIGGER insertions_refuse_update BEFORE UPDATE ON insertions BEGIN SELECT RAISE(ABORT, 'insertions is append-only'); END;
CREATE TRIGGER insertions_refuse_delete BEFORE DELETE ON insertions BEGIN SELECT RAISE(ABORT, 'insertions is append-only'); END;
CREATE INDEX ix_ledger_reached_at ON ledger (reached_at);
CREATE INDEX ix_ledger_case_id_sequence ON ledger (case_id, sequence);
CREATE INDEX ix_ledger_actor_sequence ON ledger (actor, sequence);
CREATE INDEX ix_ledger_action_sequence ON ledger (action, sequence);
CREATE INDEX ix_verdicts_code_attempt_id ON verdicts (code, attempt_id);
CREATE INDEX ix_verdicts_hazard_attempt_id ON verdicts (hazard, attempt_id);
CREATE TRIGGER ledger_refuse_update BEFORE UPDATE ON ledger BEGIN SELECT RAISE(ABORT, 'ledger is append-only'); END;
CREATE TRIGGER ledger_refuse_delete BEFORE DELETE ON ledger BEGIN SELECT RAISE(ABORT, 'ledger is append-only'); END;
CREATE TRIGGER checkpoints_refuse_update BEFORE UPDATE ON checkpoints BEGIN SELECT RAISE(ABORT, 'checkpoints is append-only'); END;
CREATE TRIGGER checkpoints_refuse_delete BEFORE DELETE ON checkpoints BEGIN SELECT RAISE(ABORT, 'checkpoints is append-only'); END;
COMMIT;
